# The content of a wheel that scripts/wheel makes (-DTROUPE_WHEEL=ON; docs/install.md): in addition to the Python package, the
# worlds, and all that a plug-in is built with (the static libraries, their headers, Eigen's headers and a package for
# find_package(troupe)). The libraries of programs of one's own (models, worldio, troupe, live) are left out, because their
# dependencies are not in the wheel. All paths are below the Python package.

include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

# Normalized, because the exported targets count the folders between the prefix and their file.
cmake_path(SET in_package NORMALIZE ${TROUPE_PYTHON_INSTALL_DIR}/troupe)
set(package_dir ${in_package}/lib/cmake/troupe)
set(header_dir ${in_package}/include/troupe)

set(CMAKE_INSTALL_DEFAULT_COMPONENT_NAME python)
install(TARGETS troupe_base troupe_partition troupe_engine troupe_sensors troupe_plugin EXPORT troupe
        ARCHIVE DESTINATION ${in_package}/lib FILE_SET HEADERS DESTINATION ${header_dir})
install(FILES ${PROJECT_SOURCE_DIR}/troupe/plugin.hpp ${PROJECT_SOURCE_DIR}/troupe/plugin_layout.hpp
              ${PROJECT_SOURCE_DIR}/troupe/plugin_library.hpp ${PROJECT_BINARY_DIR}/generated/troupe/version.hpp
        DESTINATION ${header_dir}/troupe)
# Headers for controllers that use devices or the beams of rangers (docs/controllers.md). They need no code of troupe_models.
install(DIRECTORY ${PROJECT_SOURCE_DIR}/models/devices DESTINATION ${header_dir}/models
        FILES_MATCHING PATTERN "*.hpp" PATTERN "lowest.hpp" EXCLUDE)
install(FILES ${PROJECT_SOURCE_DIR}/models/controllers/beams.hpp DESTINATION ${header_dir}/models/controllers)
install(EXPORT troupe NAMESPACE troupe:: FILE troupeTargets.cmake DESTINATION ${package_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/troupe-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_SOURCE_DIR}/cmake/wheel/troupe-config.cmake ${PROJECT_BINARY_DIR}/troupe-config-version.cmake
              ${PROJECT_SOURCE_DIR}/cmake/TroupePlugin.cmake
        DESTINATION ${package_dir})

# Only the modules of Eigen that are compiled with Troupe's headers, which need no other folder than Eigen/.
get_target_property(eigen_dir Eigen3::Eigen INTERFACE_INCLUDE_DIRECTORIES)
install(DIRECTORY ${eigen_dir}/Eigen DESTINATION ${in_package}/include/eigen3)

install(DIRECTORY ${PROJECT_SOURCE_DIR}/worlds DESTINATION ${in_package}/share/troupe PATTERN "*.py" EXCLUDE
        PATTERN "scenes.json" EXCLUDE)  # only for tests and benchmarks
install(FILES ${PROJECT_SOURCE_DIR}/docs/world.schema.json DESTINATION ${in_package}/share/troupe)

if(TROUPE_WHEEL_LICENSES)
  install(DIRECTORY ${TROUPE_WHEEL_LICENSES}/ DESTINATION ${SKBUILD_METADATA_DIR}/licenses/third-party)
endif()
