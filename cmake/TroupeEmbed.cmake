# troupe_embed_text(TARGET FILE HEADER NAME): compiles the text FILE into a target, as the std::string_view NAME that
# HEADER declares. FILE and HEADER are relative to the current folder.
function(troupe_embed_text target file header name)
  cmake_path(GET CMAKE_CURRENT_SOURCE_DIR FILENAME folder)
  set(source ${CMAKE_CURRENT_BINARY_DIR}/${name}.cpp)
  set(script ${PROJECT_SOURCE_DIR}/cmake/embed_text.cmake)
  add_custom_command(
    OUTPUT ${source}
    COMMAND ${CMAKE_COMMAND} -DTEXT=${CMAKE_CURRENT_SOURCE_DIR}/${file} -DHEADER=${folder}/${header}
            -DNAMESPACE=troupe::${folder} -DNAME=${name} -DSOURCE=${source} -P ${script}
    DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/${file} ${script}
    VERBATIM)
  target_sources(${target} PRIVATE ${source})
  # The standard guarantees only 64 KiB for a string literal; gcc and clang have no such limit.
  set_source_files_properties(${source} PROPERTIES COMPILE_OPTIONS -Wno-overlength-strings)
endfunction()
