# Run at every build: the revision may have changed since CMake configured. Rewrites the file only when it did.
execute_process(COMMAND git -C ${SOURCE} describe --always --dirty --abbrev=12 OUTPUT_VARIABLE GIT_REVISION
                OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failed)
if(failed)
  set(GIT_REVISION unknown)
endif()
configure_file(${SOURCE}/app/chain/build_info.cpp.in ${OUTPUT} @ONLY)
