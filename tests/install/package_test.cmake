# Makes the Debian packages, unpacks them and runs the program that is in them.
#   cmake -DBUILD=... -DSCRATCH=... -P package_test.cmake

function(run)
  execute_process(COMMAND ${ARGN} WORKING_DIRECTORY ${BUILD} RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT result EQUAL 0)
    message(FATAL_ERROR "${ARGN} ended with ${result}:\n${output}")
  endif()
  set(output "${output}" PARENT_SCOPE)
endfunction()

file(REMOVE_RECURSE ${SCRATCH})
run(cpack -G DEB -B ${SCRATCH})
foreach(name troupe libtroupe-dev)
  file(GLOB package ${SCRATCH}/${name}_*.deb)
  if(NOT package)
    message(FATAL_ERROR "there is no package ${name}")
  endif()
  run(dpkg-deb -x ${package} ${SCRATCH}/root)
endforeach()
file(GLOB package ${SCRATCH}/troupe_*.deb)
run(dpkg-deb -f ${package} Depends)
if(NOT output MATCHES "libosmesa6.*libc6.*libhdf5" AND NOT output MATCHES "libtbb12")
  message(FATAL_ERROR "the program's package does not say what it needs: ${output}")
endif()
foreach(file share/man/man1/troupe.1 share/bash-completion/completions/troupe share/zsh/site-functions/_troupe
             share/fish/vendor_completions.d/troupe.fish share/troupe/world.schema.json include/troupe/troupe/troupe.hpp
             lib/cmake/troupe/troupeConfig.cmake share/doc/troupe/README.md share/doc/troupe/LICENSE
             share/doc/troupe/CITATION.cff share/doc/troupe/docs/tutorial.md)
  if(NOT EXISTS ${SCRATCH}/root/usr/${file})
    message(FATAL_ERROR "no package holds ${file}")
  endif()
endforeach()
run(${SCRATCH}/root/usr/bin/troupe run ${SCRATCH}/root/usr/share/troupe/worlds/minimal.world --for 1 --quiet --json)
if(NOT output MATCHES "\"ticks\":10,")
  message(FATAL_ERROR "the program of the package printed ${output}")
endif()
file(REMOVE_RECURSE ${SCRATCH})
