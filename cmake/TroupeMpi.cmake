# The modules through which the program uses MPI at run time (docs/cluster.md): one for each MPI whose compiler wrapper is
# installed. Nothing else is compiled with MPI or linked to it. The target troupe_mpi builds them all, and the variable
# troupe_mpi_modules lists their MPIs.

set(troupe_mpi_modules)
add_custom_target(troupe_mpi)

function(troupe_add_mpi_module name)
  find_program(TROUPE_MPICC_${name} mpicc.${name} DOC "Compiler wrapper of the MPI ${name}")
  mark_as_advanced(TROUPE_MPICC_${name})
  if(NOT TROUPE_MPICC_${name})
    return()
  endif()
  set(module ${PROJECT_BINARY_DIR}/bin/libtroupe_mpi_${name}.so)
  set(source ${PROJECT_SOURCE_DIR}/partition/mpi/mpi_module)
  file(MAKE_DIRECTORY ${PROJECT_BINARY_DIR}/bin)
  add_custom_command(OUTPUT ${module}
                     COMMAND ${TROUPE_MPICC_${name}} -shared -fPIC -O2 -Wall -Wextra -o ${module} ${source}.c
                     DEPENDS ${source}.c ${source}.h COMMENT "Building the module for ${name}" VERBATIM)
  add_custom_target(troupe_mpi_${name} ALL DEPENDS ${module})
  add_dependencies(troupe_mpi troupe_mpi_${name})
  install(FILES ${module} DESTINATION lib/troupe COMPONENT mpi)  # where the program looks for it
  set(troupe_mpi_modules ${troupe_mpi_modules} ${name} PARENT_SCOPE)
endfunction()

troupe_add_mpi_module(openmpi)
troupe_add_mpi_module(mpich)
