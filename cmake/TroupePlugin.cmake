# troupe_add_plugin(NAME SOURCE...): a plug-in NAME.so with the controllers and sensors of these sources
# (docs/controllers.md, docs/extending.md). Only its entry point is exported, so that the symbols of plug-ins cannot
# clash.
function(troupe_add_plugin name)
  add_library(${name} MODULE ${ARGN})
  target_link_libraries(${name} PRIVATE troupe::plugin)
  set_target_properties(${name} PROPERTIES PREFIX "" CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON)
endfunction()
