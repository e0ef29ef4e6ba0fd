# One static library a folder. What every user of the headers must compile with, because the headers inline
# arithmetic whose bits are promised (docs/determinism.md), travels on the base library as a usage requirement.

add_library(troupe_warnings INTERFACE)
target_compile_options(troupe_warnings INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion
                       -Wno-missing-field-initializers)

function(troupe_add_library folder)
  cmake_parse_arguments(arg "" "" "SOURCES;LINK;PRIVATE_LINK" ${ARGN})
  add_library(troupe_${folder} STATIC ${arg_SOURCES})
  add_library(troupe::${folder} ALIAS troupe_${folder})
  set_target_properties(troupe_${folder} PROPERTIES EXPORT_NAME ${folder} POSITION_INDEPENDENT_CODE ON)
  target_compile_features(troupe_${folder} PUBLIC cxx_std_20)
  target_include_directories(troupe_${folder} PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>)
  target_link_libraries(troupe_${folder} PUBLIC ${arg_LINK}
                        PRIVATE $<BUILD_INTERFACE:troupe_warnings> ${arg_PRIVATE_LINK})
endfunction()
