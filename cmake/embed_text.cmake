# Writes SOURCE, which defines NAME in NAMESPACE as the content of TEXT; HEADER declares it. Called by troupe_embed_text.
file(READ "${TEXT}" text)
set(mark TROUPE_TEXT)
if(text MATCHES "\\)${mark}\"")
  message(FATAL_ERROR "${TEXT}: contains )${mark}\", which would end the raw string literal")
endif()
# With the suffix sv, gcc need not count the characters of the literal, which takes it a second.
file(WRITE "${SOURCE}" "#include \"${HEADER}\"\n\nnamespace ${NAMESPACE} {\n\nusing namespace std::literals;\n\nconst std::string_view ${NAME} = R\"${mark}(${text})${mark}\"sv;\n\n}  // namespace ${NAMESPACE}\n")
