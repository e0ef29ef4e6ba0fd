# One static library per folder. Compile options that every user of the headers needs, because the headers inline
# arithmetic with guaranteed results (docs/determinism.md), are usage requirements of the base library.

add_library(troupe_warnings INTERFACE)
target_compile_options(troupe_warnings INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion
                       -Wno-missing-field-initializers)
# No object depends on the folder of the clone, so that ccache finds it again in another one.
target_compile_options(troupe_warnings INTERFACE -ffile-prefix-map=${PROJECT_SOURCE_DIR}/=)
# By default gcc collects garbage at 128 MB, which a precompiled header nearly fills. Collecting takes up to a fifth of the time
# of the largest units, which without it need 1.6 instead of 1.4 GB.
target_compile_options(troupe_warnings INTERFACE $<$<CXX_COMPILER_ID:GNU>:--param=ggc-min-heapsize=2097152>)

# Code in which no tick spends time is compiled at -Og where a release uses -O3: in such sources, optimisation takes most of the
# compile time. See troupe_compile_briefly().
set(troupe_brief_option)
if(CMAKE_CXX_FLAGS_RELEASE MATCHES "-O3" AND (NOT CMAKE_BUILD_TYPE OR CMAKE_BUILD_TYPE STREQUAL "Release"))
  set(troupe_brief_option $<$<CONFIG:Release>:-Og>)
endif()

# Headers that nearly every source includes (standard library, Eigen, fmt) are precompiled by base. Code at -Og uses no
# precompiled header: with this one, which is compiled at -O3, gcc makes larger code of it, and one at -Og would take longer to
# make than its few large units gain.
# -DCMAKE_DISABLE_PRECOMPILE_HEADERS=ON turns precompiled headers off. Our own headers, which would save 2 % more, are
# not precompiled: ccache reuses a precompiled header in another checkout, whose headers `#pragma once` does not
# recognise as the same files.
set(CMAKE_PCH_PROLOGUE "")  # CMake's default marks everything as a system header, which hides warnings about our headers
set(troupe_precompiled_headers
    <algorithm> <any> <array> <atomic> <charconv> <cmath> <compare> <cstdint> <cstring> <exception> <functional>
    <limits> <map> <memory> <mutex> <numeric> <optional> <set> <span> <stdexcept> <string> <string_view> <tuple>
    <unordered_map> <utility> <variant> <vector> <Eigen/Core> <fmt/format.h>)

# Checks that every header compiles by itself. A header that its own source includes first is checked there; each of the
# others gets a source in the target all_verify_interface_header_sets.
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
#   LINK          libraries that its headers need
#   PRIVATE_LINK  libraries that only its sources need; users of a static library still link them
#   BUILD_LINK    header-only libraries that only its sources need; users do not need them
# Every header of the folder and its subfolders must compile by itself. Headers that internal_headers.txt does not name are
# public and installed.
set(internal_list ${CMAKE_CURRENT_LIST_DIR}/internal_headers.txt)
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${internal_list})
file(STRINGS ${internal_list} troupe_internal_headers REGEX "^[^#]")

# Libraries that are unity builds unless -DCMAKE_UNITY_BUILD is set: most of their compile time goes into templates that
# their sources share. Of base and partition, which contain much hot code, only some sources are compiled together.
set(troupe_unity_libraries engine sensors models worldio render troupe live)

function(troupe_add_library folder)
  cmake_parse_arguments(arg "" "" "SOURCES;LINK;PRIVATE_LINK;BUILD_LINK" ${ARGN})
  add_library(troupe_${folder} STATIC ${arg_SOURCES})
  add_library(troupe::${folder} ALIAS troupe_${folder})
  set_target_properties(troupe_${folder} PROPERTIES EXPORT_NAME ${folder} POSITION_INDEPENDENT_CODE ON)
  target_compile_features(troupe_${folder} PUBLIC cxx_std_20)
  if(${folder} IN_LIST troupe_unity_libraries)
    cmake_language(EVAL CODE "cmake_language(DEFER CALL troupe_compile_rest_together troupe_${folder})")
  endif()
  file(GLOB_RECURSE headers CONFIGURE_DEPENDS *.hpp)
  set(public_headers)
  foreach(header ${headers})
    cmake_path(RELATIVE_PATH header BASE_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR} OUTPUT_VARIABLE name)
    cmake_path(GET name PARENT_PATH room)
    if("!${folder}/${name}" IN_LIST troupe_internal_headers OR NOT (
       ${folder} IN_LIST troupe_internal_headers OR ${folder}/${room} IN_LIST troupe_internal_headers OR
       ${folder}/${name} IN_LIST troupe_internal_headers))
      list(APPEND public_headers ${header})
    endif()
  endforeach()
  target_sources(troupe_${folder} PUBLIC FILE_SET HEADERS BASE_DIRS ${PROJECT_SOURCE_DIR} FILES ${public_headers})
  troupe_verify_headers(${folder} "${headers}" "${arg_SOURCES}")
  target_link_libraries(troupe_${folder} PUBLIC ${arg_LINK}
                        PRIVATE $<BUILD_INTERFACE:troupe_warnings> ${arg_PRIVATE_LINK})
  if(${folder} STREQUAL base)
    target_precompile_headers(troupe_base PRIVATE ${troupe_precompiled_headers})
  else()
    target_precompile_headers(troupe_${folder} REUSE_FROM troupe_base)
  endif()
  foreach(library ${arg_BUILD_LINK})
    target_link_libraries(troupe_${folder} PRIVATE $<BUILD_INTERFACE:${library}>)
  endforeach()
endfunction()

# troupe_compile_together(TARGET GROUP SOURCES...): makes TARGET a unity build unless -DCMAKE_UNITY_BUILD is set, in which the
# sources of a group are compiled in units of equal size, of at most 40 sources. Sources of no group are compiled alone.
set(troupe_unit_size 40)
function(troupe_compile_together target group)
  if(DEFINED CMAKE_UNITY_BUILD)
    return()
  endif()
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
  list(LENGTH ARGN count)
  math(EXPR units "(${count} + ${troupe_unit_size} - 1) / ${troupe_unit_size}")
  set(index 0)
  foreach(source ${ARGN})
    math(EXPR unit "${index} * ${units} / ${count}")
    math(EXPR index "${index} + 1")
    set_source_files_properties(${source} PROPERTIES UNITY_GROUP ${group}_${unit})
  endforeach()
endfunction()

# troupe_divide_sources(HEADER INCLUDING OTHERS SOURCES...): sets the variable INCLUDING to the list of those sources that include
# <HEADER>, and OTHERS to the list of the others.
function(troupe_divide_sources header including others)
  set(list_including)
  set(list_others)
  foreach(source ${ARGN})
    set(includes)
    if(NOT IS_ABSOLUTE ${source})  # those of troupe_embed_text() are absolute, and do not exist yet
      file(STRINGS ${source} includes REGEX "^#include <${header}>" LIMIT_COUNT 1)
    endif()
    if(includes)
      list(APPEND list_including ${source})
    else()
      list(APPEND list_others ${source})
    endif()
  endforeach()
  set(${including} ${list_including} PARENT_SCOPE)
  set(${others} ${list_others} PARENT_SCOPE)
endfunction()

# Compiles together the sources of a target that are in no group and need not be compiled alone. Those that include
# nlohmann/json.hpp, which takes two seconds to compile, are in the last unit.
function(troupe_compile_rest_together target)
  set(rest)
  get_target_property(sources ${target} SOURCES)
  list(FILTER sources INCLUDE REGEX "\\.cpp$")
  foreach(source ${sources})
    get_source_file_property(group ${source} UNITY_GROUP)
    get_source_file_property(alone ${source} SKIP_UNITY_BUILD_INCLUSION)
    if(NOT group AND NOT alone)
      list(APPEND rest ${source})
    endif()
  endforeach()
  troupe_divide_sources(nlohmann/json.hpp json others ${rest})
  troupe_compile_together(${target} others ${others} ${json})
endfunction()

# troupe_compile_as(OPTION TARGET GROUP SOURCES...): compiles the units of a group of sources with an additional option, which
# may contradict those of the target, and without the precompiled header of the target, to which its own options apply.
function(troupe_compile_as option target group)
  troupe_compile_together(${target} ${group} ${ARGN})
  if(NOT troupe_brief_option)
    return()
  endif()
  set(units ${ARGN})
  if(NOT DEFINED CMAKE_UNITY_BUILD)
    set(units)
    list(LENGTH ARGN count)
    math(EXPR last "(${count} - 1) / ${troupe_unit_size}")
    foreach(unit RANGE ${last})
      list(APPEND units ${CMAKE_CURRENT_BINARY_DIR}/CMakeFiles/${target}.dir/Unity/unity_${group}_${unit}_cxx.cxx)
    endforeach()
  endif()
  set_source_files_properties(${units} PROPERTIES COMPILE_OPTIONS ${option} SKIP_PRECOMPILE_HEADERS ON)
endfunction()

# troupe_compile_briefly(TARGET) compiles a whole target briefly (see above), except for the sources for which
# troupe_compile_optimised(TARGET SOURCES...) is called, because they process much data.
# troupe_compile_briefly(TARGET SOURCES...) does it only for these sources.
function(troupe_compile_briefly target)
  if(ARGN)
    troupe_compile_as("${troupe_brief_option}" ${target} brief ${ARGN})
  elseif(troupe_brief_option)
    target_compile_options(${target} PRIVATE ${troupe_brief_option})
    set_target_properties(${target} PROPERTIES DISABLE_PRECOMPILE_HEADERS ON)
  endif()
endfunction()
function(troupe_compile_optimised target)
  troupe_compile_as($<$<CONFIG:Release>:-O3> ${target} optimised ${ARGN})
endfunction()

# troupe_compile_hot(TARGET SOURCES...): for sources in which a tick spends its time. Those of a folder are compiled together, and
# apart from all other sources, so that other sources do not change how the compiler inlines them. The sources of all folders
# with a single one are compiled together. In unity builds of the whole project (CMAKE_UNITY_BUILD), hot sources are compiled as
# all others.
function(troupe_compile_hot target)
  foreach(source ${ARGN})
    cmake_path(GET source PARENT_PATH room)
    list(APPEND hot_${room} ${source})
    list(APPEND rooms "hot_${room}")
  endforeach()
  list(REMOVE_DUPLICATES rooms)
  set(single)
  foreach(room ${rooms})
    list(LENGTH ${room} count)
    if(count EQUAL 1)
      list(APPEND single ${${room}})
    else()
      troupe_compile_together(${target} ${room} ${${room}})
    endif()
  endforeach()
  if(single)
    troupe_compile_together(${target} hot_single ${single})
  endif()
endfunction()

# For sources that a unity build (such as the preset dev, which takes a quarter of the time) must compile separately:
# each defines a name that another source of its library also defines, includes itself once for each instruction set, or
# has a class with members of file-local types, about which gcc warns in an included file.
function(troupe_compile_alone)
  set_source_files_properties(${ARGN} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
endfunction()
