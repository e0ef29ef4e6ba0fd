# Installs the build, moves the install tree, builds the example against it, and runs it.
#   cmake -DSOURCE=... -DBUILD=... -DSCRATCH=... -DGENERATOR=... -DCXX=... -DCXX_FLAGS=... -DBUILD_TYPE=...
#         -DPYTHON=... -P install_test.cmake

function(run)
  cmake_parse_arguments(arg "" "OUTPUT;IN" "" ${ARGN})
  execute_process(COMMAND ${arg_UNPARSED_ARGUMENTS} RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output
                  WORKING_DIRECTORY ${arg_IN})
  if(NOT result EQUAL 0)
    list(JOIN arg_UNPARSED_ARGUMENTS " " command)
    message(FATAL_ERROR "${command}\nended with ${result}:\n${output}")
  endif()
  set(${arg_OUTPUT} "${output}" PARENT_SCOPE)
endfunction()

file(REMOVE_RECURSE ${SCRATCH})
file(MAKE_DIRECTORY ${SCRATCH})

run(IN ${SCRATCH} ${CMAKE_COMMAND} --install ${BUILD} --prefix ${SCRATCH}/installed)
file(RENAME ${SCRATCH}/installed ${SCRATCH}/prefix)  # an install tree may be moved

# Nothing that is installed for find_package may point back at where it was built.
file(GLOB_RECURSE package ${SCRATCH}/prefix/*.cmake)
if(NOT package)
  message(FATAL_ERROR "no package files were installed")
endif()
foreach(file ${package})
  file(READ ${file} text)
  foreach(path ${SOURCE} ${BUILD} ${SCRATCH})
    string(FIND "${text}" "${path}" at)
    if(NOT at EQUAL -1)
      message(FATAL_ERROR "${file} names ${path}")
    endif()
  endforeach()
endforeach()

# The headers bring Eigen and the standard library, nothing else, and no header that is not installed.
file(GLOB_RECURSE headers ${SCRATCH}/prefix/include/*)
foreach(file ${headers})
  file(STRINGS ${file} foreign REGEX "^[ \t]*#[ \t]*include[ \t]*<[^>]*[/.]")
  list(FILTER foreign EXCLUDE REGEX "<Eigen/")
  if(foreign)
    message(FATAL_ERROR "${file}: ${foreign}")
  endif()
  file(STRINGS ${file} own REGEX "^#include \"")
  foreach(line ${own})
    string(REGEX REPLACE "^#include \"([^\"]*)\".*" "\\1" name "${line}")
    if(NOT EXISTS ${SCRATCH}/prefix/include/troupe/${name})
      message(FATAL_ERROR "${file} includes ${name}, which is not installed")
    endif()
  endforeach()
endforeach()

run(IN ${SCRATCH} ${CMAKE_COMMAND} -S ${SOURCE}/tests/install -B ${SCRATCH}/consumer -G ${GENERATOR}
    -DMINIMAL_CPP=${SOURCE}/apps/examples/minimal.cpp -DCMAKE_PREFIX_PATH=${SCRATCH}/prefix
    -DCMAKE_CXX_COMPILER=${CXX} -DCMAKE_CXX_FLAGS=${CXX_FLAGS} -DCMAKE_BUILD_TYPE=${BUILD_TYPE}
    -DCMAKE_EXPORT_COMPILE_COMMANDS=ON)
file(READ ${SCRATCH}/consumer/compile_commands.json commands)
foreach(flag -ffp-contract=off -DEIGEN_DONT_VECTORIZE -DEIGEN_MAX_ALIGN_BYTES=16)
  string(FIND "${commands}" "${flag}" at)
  if(at EQUAL -1)
    message(FATAL_ERROR "the consumer is compiled without ${flag}: ${commands}")
  endif()
endforeach()

run(IN ${SCRATCH} ${CMAKE_COMMAND} --build ${SCRATCH}/consumer)
run(IN ${SOURCE} OUTPUT printed ${SCRATCH}/consumer/minimal worlds/minimal.world)
# A circle of 4 m radius from (-3.5, 2), heading -45 degrees, 10 s at 0.2 m/s, in steps of 0.1 s.
if(NOT printed MATCHES "^r0 is at \\(-1\\.80[0-9]*, 0\\.98[0-9]*\\) m, the nearest thing [0-9.]+ m away\n$")
  message(FATAL_ERROR "the example printed:\n${printed}")
endif()

# The examples, far from the source tree, each with its own CMakeLists: plug-ins run in the installed program and in a
# program of one's own.
function(build_example name)
  cmake_parse_arguments(arg "" "INTO" "AGAINST" ${ARGN})
  if(NOT arg_INTO)
    set(arg_INTO build)
    set(arg_AGAINST -DCMAKE_PREFIX_PATH=${SCRATCH}/prefix)
  endif()
  file(COPY ${SCRATCH}/prefix/share/doc/troupe/apps/examples/${name} DESTINATION ${SCRATCH})
  run(IN ${SCRATCH} ${CMAKE_COMMAND} -S ${SCRATCH}/${name} -B ${SCRATCH}/${name}/${arg_INTO} -G ${GENERATOR} ${arg_AGAINST}
      -DCMAKE_CXX_COMPILER=${CXX} -DCMAKE_CXX_FLAGS=${CXX_FLAGS} -DCMAKE_BUILD_TYPE=${BUILD_TYPE})
  run(IN ${SCRATCH} ${CMAKE_COMMAND} --build ${SCRATCH}/${name}/${arg_INTO})
endfunction()
build_example(plugin)
build_example(sensor_plugin)
run(IN ${SCRATCH}/plugin OUTPUT described ${SCRATCH}/prefix/bin/troupe describe follow_wall --plugin-path build)
if(NOT described MATCHES "controller follow_wall: keep a wall at the left\n.*distance_m")
  message(FATAL_ERROR "troupe describe follow_wall printed:\n${described}")
endif()
run(IN ${SCRATCH}/sensor_plugin OUTPUT described ${SCRATCH}/prefix/bin/troupe describe beam_ranger --plugin-path build)
if(NOT described MATCHES "sensor beam_ranger: a ranger some of whose beams .*short_share")
  message(FATAL_ERROR "troupe describe beam_ranger printed:\n${described}")
endif()
foreach(example plugin sensor_plugin)
  run(IN ${SCRATCH}/${example} OUTPUT summary
      ${SCRATCH}/prefix/bin/troupe run room.json --for 10 --plugin-path build --quiet --json)
  run(IN ${SCRATCH}/${example} OUTPUT hash ${SCRATCH}/consumer/runs_plugin room.json build)
  string(STRIP "${hash}" hash)
  if(NOT hash MATCHES "^[0-9a-f]+$" OR NOT summary MATCHES "\"state_hash\":\"${hash}\"")
    message(FATAL_ERROR "${example}: the program ends at ${hash}, troupe run with:\n${summary}")
  endif()
endforeach()

# A thousand trials of one world, which end with the same state everywhere.
build_example(evolution)
run(IN ${SCRATCH} OUTPUT printed ${SCRATCH}/evolution/build/evolve)
if(NOT printed MATCHES "after +20 trials: 0\\.[0-9]+ of the room\n.*the best covers 0\\.[0-9]+, state 3d7de78fb366170a\n$")
  message(FATAL_ERROR "evolve printed:\n${printed}")
endif()

# A study whose table does not depend on how many cores carry it out.
build_example(seeds)
run(IN ${SCRATCH} OUTPUT table ${SCRATCH}/seeds/build/seeds ${SOURCE}/apps/examples/study/room.json)
run(IN ${SCRATCH} OUTPUT again ${SCRATCH}/seeds/build/seeds ${SOURCE}/apps/examples/study/room.json 1)
string(REGEX MATCHALL "\n" lines "${table}")
list(LENGTH lines lines)
if(NOT lines EQUAL 33 OR NOT table STREQUAL again)
  message(FATAL_ERROR "the study printed:\n${table}\nand on one core:\n${again}")
endif()

# The README's program in an empty folder, against the build tree.
file(COPY ${SOURCE}/apps/examples/minimal.cpp DESTINATION ${SCRATCH}/try)
file(WRITE ${SCRATCH}/try/CMakeLists.txt "cmake_minimum_required(VERSION 3.25)\nproject(minimal LANGUAGES CXX)\n"
     "find_package(troupe REQUIRED)\nadd_executable(minimal minimal.cpp)\n"
     "target_link_libraries(minimal PRIVATE troupe::troupe)\n")
run(IN ${SCRATCH} ${CMAKE_COMMAND} -S ${SCRATCH}/try -B ${SCRATCH}/try/build -G ${GENERATOR} -Dtroupe_DIR=${BUILD}
    -DCMAKE_CXX_COMPILER=${CXX} -DCMAKE_CXX_FLAGS=${CXX_FLAGS} -DCMAKE_BUILD_TYPE=${BUILD_TYPE})
run(IN ${SCRATCH} ${CMAKE_COMMAND} --build ${SCRATCH}/try/build)
run(IN ${SOURCE} OUTPUT again ${SCRATCH}/try/build/minimal worlds/minimal.world)
run(IN ${SOURCE} OUTPUT printed ${SCRATCH}/consumer/minimal worlds/minimal.world)
if(NOT again STREQUAL printed)
  message(FATAL_ERROR "against the build tree the example printed:\n${again}")
endif()

# A sensor that was built against the build tree, whose headers and libraries are the installed ones.
build_example(sensor_plugin INTO against_build AGAINST -Dtroupe_DIR=${BUILD})
run(IN ${SCRATCH}/sensor_plugin OUTPUT again ${SCRATCH}/consumer/runs_plugin room.json against_build)
run(IN ${SCRATCH}/sensor_plugin OUTPUT printed ${SCRATCH}/consumer/runs_plugin room.json build)
if(NOT again STREQUAL printed)
  message(FATAL_ERROR "built against the build tree, the sensor leads to ${again}, else to ${printed}")
endif()

# The Python package, from where it was installed.
if(EXISTS ${SCRATCH}/prefix/lib/python3/dist-packages/troupe)
  run(IN ${SOURCE} OUTPUT printed ${CMAKE_COMMAND} -E env PYTHONPATH=${SCRATCH}/prefix/lib/python3/dist-packages
      PYTHONDONTWRITEBYTECODE=1 ${PYTHON} -c
      "import troupe\nprint(troupe.__file__)\nprint(min(troupe.Simulation('worlds/minimal.world').find('r0').pose()))")
  if(NOT printed MATCHES "^${SCRATCH}/prefix/lib/python3/dist-packages/troupe/__init__.py\n-3.5\n$")
    message(FATAL_ERROR "the installed Python package printed:\n${printed}")
  endif()
endif()
file(REMOVE_RECURSE ${SCRATCH})
