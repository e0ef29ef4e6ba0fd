# cpack runs this before it makes a package.
foreach(program dpkg-shlibdeps file)
  find_program(found_${program} ${program})
  if(CPACK_GENERATOR MATCHES DEB AND NOT found_${program})
    message(FATAL_ERROR "cpack -G DEB needs ${program} to find the dependencies of the program: apt install dpkg-dev file")
  endif()
endforeach()
