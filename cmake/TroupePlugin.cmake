# troupe_add_plugin(NAME SOURCE...): a plug-in NAME.so with the controllers and sensors of these sources
# (docs/controllers.md, docs/extending.md). Only its entry point is exported, so that the symbols of plug-ins cannot
# clash. Without a build type, CMake would compile it without optimisation, and its controllers would take ten times as
# long.
function(troupe_add_plugin name)
  add_library(${name} MODULE ${ARGN})
  target_link_libraries(${name} PRIVATE troupe::plugin)
  set_target_properties(${name} PROPERTIES PREFIX "" CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON)
  get_property(has_configurations GLOBAL PROPERTY GENERATOR_IS_MULTI_CONFIG)
  if(NOT has_configurations AND NOT CMAKE_BUILD_TYPE)
    target_compile_options(${name} PRIVATE -O3 -DNDEBUG)
    message(STATUS "Plug-in ${name}: no CMAKE_BUILD_TYPE is given, so it is compiled with -O3")
  endif()
endfunction()
