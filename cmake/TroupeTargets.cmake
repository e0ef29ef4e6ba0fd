# One static library a folder. What every user of the headers must compile with, because the headers inline
# arithmetic whose bits are promised (docs/determinism.md), travels on the base library as a usage requirement.

add_library(troupe_warnings INTERFACE)
target_compile_options(troupe_warnings INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion
                       -Wno-missing-field-initializers)
# gcc looks for garbage whenever it holds 128 MB, which a precompiled header nearly fills.
target_compile_options(troupe_warnings INTERFACE $<$<CXX_COMPILER_ID:GNU>:--param=ggc-min-heapsize=524288>)

# What nearly every source includes is parsed once, for the engine and all libraries above it: the standard library,
# Eigen and fmt. In base and partition it would take as long as it saves. -DCMAKE_DISABLE_PRECOMPILE_HEADERS=ON builds
# without. None of our own headers, which would save 2 % more: ccache hands a precompiled header on to another checkout,
# whose own headers `#pragma once` does not take for the same files.
set(CMAKE_PCH_PROLOGUE "")  # CMake's own calls all of it a system header, which hides warnings about ours
set(troupe_precompiled_headers
    <algorithm> <any> <array> <atomic> <charconv> <cmath> <compare> <cstdint> <cstring> <exception> <filesystem> <functional>
    <limits> <map> <memory> <mutex> <numeric> <optional> <set> <span> <stdexcept> <string> <string_view> <tuple>
    <unordered_map> <utility> <variant> <vector> <Eigen/Core> <fmt/format.h>)

# That a header compiles by itself is seen wherever the source of its name includes it first. The others get a source
# of their own each, in the target all_verify_interface_header_sets.
function(troupe_verify_headers folder headers sources)
  set(others)
  foreach(header ${headers})
    cmake_path(RELATIVE_PATH header BASE_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR} OUTPUT_VARIABLE name)
    cmake_path(REMOVE_EXTENSION name LAST_ONLY)
    set(first)
    if("${name}.cpp" IN_LIST sources)
      file(STRINGS ${name}.cpp first REGEX "^#include" LIMIT_COUNT 1)
    endif()
    if(NOT first STREQUAL "#include \"${folder}/${name}.hpp\"")
      list(APPEND others ${header})
    endif()
  endforeach()
  set_target_properties(troupe_${folder} PROPERTIES VERIFY_INTERFACE_HEADER_SETS OFF)
  if(others)
    add_library(troupe_${folder}_headers INTERFACE)
    target_sources(troupe_${folder}_headers INTERFACE FILE_SET HEADERS BASE_DIRS ${PROJECT_SOURCE_DIR} FILES ${others})
    target_link_libraries(troupe_${folder}_headers INTERFACE troupe_${folder})
  endif()
endfunction()

# troupe_add_library(FOLDER SOURCES ... [LINK ...] [PRIVATE_LINK ...] [BUILD_LINK ...])
#   LINK          what its headers need
#   PRIVATE_LINK  what only its sources need; a static library's users link it all the same
#   BUILD_LINK    what only its sources need and only to compile (header-only libraries): users need not have it
# Every header of the folder, and of the folders in it, must compile by itself. Those are public, and installed, that internal_headers.txt does not name.
set(internal_list ${CMAKE_CURRENT_LIST_DIR}/internal_headers.txt)
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${internal_list})
file(STRINGS ${internal_list} troupe_internal_headers REGEX "^[^#]")

# Libraries whose sources are compiled many at a time, unless -DCMAKE_UNITY_BUILD says otherwise for all: most of what
# they compile are templates that their neighbours use, too. The others hold what is edited most (models), what a
# tick spends its time in, or the same names for the same things.
set(troupe_unity_libraries engine worldio render troupe)

function(troupe_add_library folder)
  cmake_parse_arguments(arg "" "" "SOURCES;LINK;PRIVATE_LINK;BUILD_LINK" ${ARGN})
  add_library(troupe_${folder} STATIC ${arg_SOURCES})
  add_library(troupe::${folder} ALIAS troupe_${folder})
  set_target_properties(troupe_${folder} PROPERTIES EXPORT_NAME ${folder} POSITION_INDEPENDENT_CODE ON)
  target_compile_features(troupe_${folder} PUBLIC cxx_std_20)
  if(${folder} IN_LIST troupe_unity_libraries AND NOT DEFINED CMAKE_UNITY_BUILD)
    set_target_properties(troupe_${folder} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 12)
  endif()
  file(GLOB_RECURSE headers CONFIGURE_DEPENDS *.hpp)
  set(public_headers)
  foreach(header ${headers})
    cmake_path(RELATIVE_PATH header BASE_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR} OUTPUT_VARIABLE name)
    if("!${folder}/${name}" IN_LIST troupe_internal_headers OR NOT (
       ${folder} IN_LIST troupe_internal_headers OR ${folder}/${name} IN_LIST troupe_internal_headers))
      list(APPEND public_headers ${header})
    endif()
  endforeach()
  target_sources(troupe_${folder} PUBLIC FILE_SET HEADERS BASE_DIRS ${PROJECT_SOURCE_DIR} FILES ${public_headers})
  troupe_verify_headers(${folder} "${headers}" "${arg_SOURCES}")
  target_link_libraries(troupe_${folder} PUBLIC ${arg_LINK}
                        PRIVATE $<BUILD_INTERFACE:troupe_warnings> ${arg_PRIVATE_LINK})
  if(${folder} STREQUAL engine)
    target_precompile_headers(troupe_engine PRIVATE ${troupe_precompiled_headers})
  elseif(NOT ${folder} MATCHES "^(base|partition)$")
    target_precompile_headers(troupe_${folder} REUSE_FROM troupe_engine)
  endif()
  foreach(library ${arg_BUILD_LINK})
    target_link_libraries(troupe_${folder} PRIVATE $<BUILD_INTERFACE:${library}>)
  endforeach()
endfunction()

# troupe_compile_briefly(TARGET): at -O1 where a release is compiled at -O3, for what no tick spends time in. Of such
# sources three quarters of the time go into optimising.
function(troupe_compile_briefly target)
  if(CMAKE_CXX_FLAGS_RELEASE MATCHES "-O3")
    target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-O1>)
  endif()
endfunction()

# Sources of such a target that work on much data after all; they are compiled by themselves.
function(troupe_compile_optimised)
  if(CMAKE_CXX_FLAGS_RELEASE MATCHES "-O3")
    set_source_files_properties(${ARGN} PROPERTIES COMPILE_OPTIONS $<$<CONFIG:Release>:-O3>)
  endif()
endfunction()

# Sources that take part in the unity builds of the presets that are unity builds as a whole, and in no others: a tick
# spends its time in them, and what they are inlined into is to stay as it is.
function(troupe_compile_hot)
  if(NOT CMAKE_UNITY_BUILD)
    troupe_compile_alone(${ARGN})
  endif()
endfunction()

# Sources that a unity build compiles by themselves (the preset dev is one, which takes a quarter of the time): each
# uses a name that another source of its library has, too, or includes itself once for each instruction set.
function(troupe_compile_alone)
  set_source_files_properties(${ARGN} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
endfunction()
