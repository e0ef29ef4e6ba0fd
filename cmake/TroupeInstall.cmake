# cmake --install: the program, the libraries with their headers in the layout of the source tree (under include/troupe,
# so that both `#include <troupe/troupe.hpp>` and the headers' own `#include "base/pose.hpp"` work), the worlds, the
# documentation, and a package for find_package(troupe). The component `development` contains what other programs need to
# build, `mpi` the modules for MPI, `program` the rest; cpack makes a Debian package of each.

include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/troupe)
set(header_dir ${CMAKE_INSTALL_INCLUDEDIR}/troupe)

set(libraries)
foreach(folder base partition engine sensors models worldio render troupe live)
  if(TARGET troupe_${folder})
    list(APPEND libraries troupe_${folder})
  endif()
endforeach()

list(APPEND libraries troupe_plugin)
set(CMAKE_INSTALL_DEFAULT_COMPONENT_NAME development)
install(TARGETS ${libraries} EXPORT troupe FILE_SET HEADERS DESTINATION ${header_dir})
install(FILES ${PROJECT_BINARY_DIR}/generated/troupe/version.hpp DESTINATION ${header_dir}/troupe)
install(EXPORT troupe NAMESPACE troupe:: FILE troupeTargets.cmake DESTINATION ${package_dir})

set(troupe_is_build_tree OFF)
configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/troupe-config.cmake.in
                              ${PROJECT_BINARY_DIR}/installed/troupe-config.cmake
                              INSTALL_DESTINATION ${package_dir} NO_SET_AND_CHECK_MACRO)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/troupe-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/installed/troupe-config.cmake ${PROJECT_BINARY_DIR}/troupe-config-version.cmake
              ${PROJECT_SOURCE_DIR}/cmake/FindHdf5C.cmake ${PROJECT_SOURCE_DIR}/cmake/TroupePlugin.cmake
        DESTINATION ${package_dir})

# The build tree is also a package: -Dtroupe_DIR=build/release. Its targets contain the compile options of the libraries.
if(PROJECT_IS_TOP_LEVEL)
  set(troupe_is_build_tree ON)
  configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/troupe-config.cmake.in ${PROJECT_BINARY_DIR}/troupe-config.cmake
                                INSTALL_DESTINATION ${PROJECT_BINARY_DIR} INSTALL_PREFIX ${PROJECT_BINARY_DIR}
                                NO_SET_AND_CHECK_MACRO)
  foreach(file FindHdf5C TroupePlugin)
    configure_file(${PROJECT_SOURCE_DIR}/cmake/${file}.cmake ${PROJECT_BINARY_DIR}/${file}.cmake COPYONLY)
  endforeach()
  export(TARGETS ${libraries} troupe_warnings NAMESPACE troupe:: FILE ${PROJECT_BINARY_DIR}/troupeTargets.cmake)
endif()

set(CMAKE_INSTALL_DEFAULT_COMPONENT_NAME program)
install(FILES ${PROJECT_SOURCE_DIR}/docs/world.schema.json DESTINATION ${CMAKE_INSTALL_DATADIR}/troupe)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/worlds DESTINATION ${CMAKE_INSTALL_DATADIR}/troupe PATTERN "*.py" EXCLUDE
        PATTERN "scenes.json" EXCLUDE)  # only for tests and benchmarks
# Pages and examples are installed in the layout of the source tree, so that the links of the pages work. Pictures are left
# out.
install(FILES README.md CHANGELOG.md CITATION.cff CONTRIBUTING.md LICENSE SECURITY.md DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(DIRECTORY docs/ DESTINATION ${CMAKE_INSTALL_DOCDIR}/docs FILES_MATCHING PATTERN "*.md" PATTERN "images" EXCLUDE)
foreach(folder apps python)
  install(DIRECTORY ${folder}/examples DESTINATION ${CMAKE_INSTALL_DOCDIR}/${folder} PATTERN "__pycache__" EXCLUDE)
endforeach()

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME troupe)
set(CPACK_PACKAGE_CONTACT "The Troupe authors")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY ${PROJECT_DESCRIPTION})
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_COMPONENTS_ALL program development)
if(troupe_mpi_modules)
  list(APPEND CPACK_COMPONENTS_ALL mpi)
endif()
set(CPACK_STRIP_FILES ON)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)

set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME troupe)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SHLIBDEPS ON)
if(TROUPE_RENDER)
  set(CPACK_DEBIAN_PROGRAM_PACKAGE_DEPENDS "libosmesa6 | libegl1")  # loaded with the first picture
endif()
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SUGGESTS "ffmpeg, libcairo2, python3-matplotlib")  # films, PDFs, troupe plot

# Only one of the MPIs is needed, so the dependencies cannot come from dpkg-shlibdeps.
set(mpi_libraries)
if(openmpi IN_LIST troupe_mpi_modules)
  list(APPEND mpi_libraries libopenmpi3)
endif()
if(mpich IN_LIST troupe_mpi_modules)
  list(APPEND mpi_libraries libmpich12)
endif()
list(JOIN mpi_libraries " | " mpi_libraries)
set(CPACK_DEBIAN_MPI_PACKAGE_NAME troupe-mpi)
set(CPACK_DEBIAN_MPI_PACKAGE_DEPENDS "troupe (= ${PROJECT_VERSION}), libc6, ${mpi_libraries}")
set(CPACK_DEBIAN_MPI_PACKAGE_SUGGESTS "openmpi-bin, mpich")  # their mpirun
set(CPACK_DEBIAN_MPI_DESCRIPTION "${PROJECT_DESCRIPTION}: modules for one world on several processes")

# The dependencies in troupe-config.cmake.
set(needed libeigen3-dev libfmt-dev libhwy-dev libpng-dev zlib1g-dev libyaml-cpp-dev)
if(TROUPE_HDF5)
  list(APPEND needed libhdf5-dev)
endif()
if(NOT TROUPE_STD_THREADS)
  list(APPEND needed libtbb-dev)
endif()
list(JOIN needed ", " CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME libtroupe-dev)
set(CPACK_DEBIAN_DEVELOPMENT_DESCRIPTION "${PROJECT_DESCRIPTION}: headers and libraries")
# Checks for tools without which cpack makes packages without dependencies, or none at all.
set(CPACK_PROJECT_CONFIG_FILE ${PROJECT_SOURCE_DIR}/cmake/TroupePackage.cmake)
include(CPack)
