# Installs modebank into a folder of its own, builds the examples against it as a robot's makers would, and runs them:
# cmake -DBUILD=... -DSOURCE=... -DWORK=... -DBUILD_TYPE=... -P check_installed.cmake
function(run)
  execute_process(COMMAND ${ARGV} RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "${ARGV}\nexit status ${status}\n${output}")
  endif()
  set(output "${output}" PARENT_SCOPE)
endfunction()

file(REMOVE_RECURSE ${WORK})
file(MAKE_DIRECTORY ${WORK})
run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${WORK}/installed)
run(${CMAKE_COMMAND} -S ${SOURCE}/tests/examples -B ${WORK}/build -G Ninja -DCMAKE_PREFIX_PATH=${WORK}/installed
    -DCMAKE_BUILD_TYPE=${BUILD_TYPE} -DCMAKE_CXX_COMPILER_LAUNCHER=${LAUNCHER})
run(${CMAKE_COMMAND} --build ${WORK}/build)

run(${WORK}/build/embedded_bank)
run(ldd ${WORK}/build/embedded_bank)
if(output MATCHES "ceres|hdf5|boost|tbb|fmt|crypto")
  message(FATAL_ERROR "modebank::filter must link none of these libraries:\n${output}")
endif()

# An archive made by the installed program.
file(WRITE ${WORK}/linear.ini "[data]\nstate = wz\ninput = velL, velR\n[simulate]\nmodes = -0.3, -0.15, 0.15\nprocess_sd = 0.01\nruns = 2\nsamples = 200\noutput = ${WORK}/runs\n")
file(WRITE ${WORK}/run.ini "[data]\ninputs = pro_*.csv\nstates = imu_*.csv\nstate = wz\ninput = velL, velR\n[mixture]\ncomponents = 2\n")
run(${WORK}/installed/bin/modebank simulate ${WORK}/linear.ini)
run(${WORK}/installed/bin/modebank run ${WORK}/run.ini --data.root ${WORK}/runs --archive.output ${WORK}/bank.h5)
run(${WORK}/build/robot_loop ${WORK}/bank.h5 1)
message(STATUS "${output}")
if(NOT output MATCHES "1000 ticks")
  message(FATAL_ERROR "robot_loop said: ${output}")
endif()
