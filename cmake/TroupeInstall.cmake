# cmake --install: the program, the libraries with their headers as they lie in the source tree (under
# include/troupe, so that `#include <troupe/troupe.hpp>` and the headers' own `#include "base/pose.hpp"` both mean
# one file), the worlds, and a package for find_package(troupe).

include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/troupe)
set(header_dir ${CMAKE_INSTALL_INCLUDEDIR}/troupe)

set(libraries)
foreach(folder base partition engine sensors models worldio render troupe)
  if(TARGET troupe_${folder})
    list(APPEND libraries troupe_${folder})
  endif()
endforeach()

list(APPEND libraries troupe_plugin)
install(TARGETS ${libraries} EXPORT troupe FILE_SET HEADERS DESTINATION ${header_dir})
install(FILES ${PROJECT_BINARY_DIR}/generated/troupe/version.hpp DESTINATION ${header_dir}/troupe)
install(EXPORT troupe NAMESPACE troupe:: FILE troupeTargets.cmake DESTINATION ${package_dir})

configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/troupeConfig.cmake.in ${PROJECT_BINARY_DIR}/troupeConfig.cmake
                              INSTALL_DESTINATION ${package_dir} NO_SET_AND_CHECK_MACRO)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/troupeConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/troupeConfig.cmake ${PROJECT_BINARY_DIR}/troupeConfigVersion.cmake
              ${PROJECT_SOURCE_DIR}/cmake/FindHdf5C.cmake ${PROJECT_SOURCE_DIR}/cmake/TroupePlugin.cmake
        DESTINATION ${package_dir})

install(FILES ${PROJECT_SOURCE_DIR}/docs/world.schema.json DESTINATION ${CMAKE_INSTALL_DATADIR}/troupe)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/worlds DESTINATION ${CMAKE_INSTALL_DATADIR}/troupe)
