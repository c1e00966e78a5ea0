# run(COMMAND...): what it prints is `output`; a failure is one of the script.
function(run)
  execute_process(COMMAND ${ARGV} RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "${ARGV}\nexit status ${status}\n${output}")
  endif()
  set(output "${output}" PARENT_SCOPE)
endfunction()

# The shared objects that a program asks for itself. (ldd lists theirs, too.)
function(needed_libraries program result)
  run(readelf -d ${program})
  # With both brackets: a list does not end its element at a semicolon behind one that is open.
  string(REGEX MATCHALL "Shared library: \\[[^]]*\\]" needed "${output}")
  list(TRANSFORM needed REPLACE "Shared library: \\[(.*)\\]" "\\1")
  set(${result} "${needed}" PARENT_SCOPE)
endfunction()
