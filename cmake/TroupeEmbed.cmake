# troupe_embed_text(TARGET FILE HEADER NAME): compiles a text of this folder into a target, as the std::string_view NAME
# that HEADER, one of this folder's, declares.
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
  # What a compiler must take at least is 64 KiB; gcc and clang take what memory holds.
  set_source_files_properties(${source} PROPERTIES COMPILE_OPTIONS -Wno-overlength-strings)
endfunction()
