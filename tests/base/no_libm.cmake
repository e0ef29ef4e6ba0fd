# Fails when a library calls one of libm's functions, whose last bits differ between processors and versions.
# usage: cmake -DNM=nm -DLIBRARY=libtroupe_base.a -P no_libm.cmake

execute_process(COMMAND ${NM} --undefined-only ${LIBRARY} OUTPUT_VARIABLE symbols RESULT_VARIABLE failed)
if(failed)
  message(FATAL_ERROR "cannot read the symbols of ${LIBRARY}")
endif()

set(functions a?sinh? a?cosh? a?tanh? atan2 sincos exp exp2 exp10 expm1 log log2 log10 log1p pow fma hypot cbrt fmod
    remainder erf tgamma lgamma)
list(JOIN functions "|" any_function)
string(REGEX MATCHALL "U (__)?(${any_function})[fl]?(_finite)?(@[^\n]*)?\n" found "${symbols}")
if(found)
  message(FATAL_ERROR "${LIBRARY} calls libm: ${found}")
endif()
