# run(COMMAND...): sets `output` to the printed text; a failure ends the script.
function(run)
  execute_process(COMMAND ${ARGV} RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "${ARGV}\nexit status ${status}\n${output}")
  endif()
  set(output "${output}" PARENT_SCOPE)
endfunction()

# Shared objects that a program needs itself; ldd would also list theirs.
function(needed_libraries program result)
  run(readelf -d ${program})
  # With both brackets, because a list element does not end at a semicolon after an open bracket.
  string(REGEX MATCHALL "Shared library: \\[[^]]*\\]" needed "${output}")
  list(TRANSFORM needed REPLACE "Shared library: \\[(.*)\\]" "\\1")
  set(${result} "${needed}" PARENT_SCOPE)
endfunction()
