# Installs modebank into a folder, builds the examples against it as a robot's developers would, and runs them: cmake -DBUILD=...
# -DSOURCE=... -DWORK=... -DPART=... -P check_installed.cmake
# PART install is first; the others use its folder and run in parallel: components, plain, wide, debug, address.
include(${CMAKE_CURRENT_LIST_DIR}/run.cmake)

# Checks the libraries that a program needs itself, beside those of every C++ program.
function(needs_only program allowed)
  needed_libraries(${program} needed)
  foreach(library IN LISTS needed)
    if(NOT library MATCHES "^(lib(c|m|stdc\\+\\+|gcc_s|${allowed})|ld-linux.*)[.]so")
      message(FATAL_ERROR "${program} must not need ${library}: ${needed}")
    endif()
  endforeach()
  message(STATUS "${program} needs ${needed}")
endfunction()

if(PART STREQUAL install)
  file(REMOVE_RECURSE ${WORK})
  file(MAKE_DIRECTORY ${WORK})
  run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${WORK}/installed)

  # An archive made by the installed program.
  file(WRITE ${WORK}/one.ini "[system]\nmodes = -0.3, -0.15, 0.15\nprocess_sd = 0.01\ninput_law = drive\n")
  file(WRITE ${WORK}/linear.ini "[data]\nstate = wz\ninput = velL, velR\n[simulate]\nsystem = one.ini\nruns = 2\nsamples = 200\noutput = ${WORK}/runs\n")
  file(WRITE ${WORK}/run.ini "[data]\ninputs = pro_*.csv\nstates = imu_*.csv\nstate = wz\ninput = velL, velR\n[mixture]\ncomponents = 2\n")
  run(${WORK}/installed/bin/modebank simulate ${WORK}/linear.ini)
  run(${WORK}/installed/bin/modebank run ${WORK}/run.ini --data.root ${WORK}/runs --archive.output ${WORK}/bank.h5)
  return()
endif()

# Each component requires exactly the libraries that it links.
if(PART STREQUAL components)
  foreach(without "filter|HDF5|OpenSSL|Ceres|TBB|fmt" "judge|HDF5|OpenSSL|Ceres|TBB|fmt" "archive|Ceres|TBB|fmt" "ident|HDF5|OpenSSL|fmt" "mixture|HDF5|OpenSSL|Ceres"
          "learn|HDF5|OpenSSL")
    string(REPLACE "|" ";" left_out "${without}")
    list(POP_FRONT left_out component)
    list(TRANSFORM left_out REPLACE "(.+)" "-DCMAKE_DISABLE_FIND_PACKAGE_\\1=ON")
    set(alone ${WORK}/alone_${component})
    file(WRITE ${alone}/CMakeLists.txt "cmake_minimum_required(VERSION 3.25)\nproject(alone LANGUAGES C CXX)\n"
         "find_package(modebank 0.1 REQUIRED COMPONENTS ${component})\n"
         "add_executable(alone ${SOURCE}/tests/examples/other_eigen.cpp)\ntarget_link_libraries(alone PRIVATE modebank::${component})\n")
    run(${CMAKE_COMMAND} -S ${alone} -B ${alone}/build -G Ninja -DCMAKE_PREFIX_PATH=${WORK}/installed ${left_out})
  endforeach()
  return()
endif()

# Users compile in their own ways: plain, for wider registers, without optimisation, under a sanitizer, and beside another library with
# Eigen that was compiled with other_flags.
set(flags_plain "-O2")
set(other_flags_plain "-O2 -march=x86-64-v3")
set(flags_wide "-O2 -march=x86-64-v3")
set(other_flags_wide "-O2")
set(flags_debug "-O0 -g -march=x86-64-v3")
set(other_flags_debug "-O0")
set(flags_address "-O1 -g -march=x86-64-v3 -fsanitize=address")
set(other_flags_address "-O2 -fsanitize=address")
if(NOT DEFINED flags_${PART})
  message(FATAL_ERROR "unknown part '${PART}'; expected install, components, plain, wide, debug or address")
endif()
set(build ${WORK}/${PART})
file(REMOVE_RECURSE ${build})
run(${CMAKE_COMMAND} -S ${SOURCE}/tests/examples -B ${build} -G Ninja -DCMAKE_PREFIX_PATH=${WORK}/installed
    "-DCMAKE_CXX_FLAGS=${flags_${PART}}" "-DOTHER_FLAGS=${other_flags_${PART}}")
run(${CMAKE_COMMAND} --build ${build})
run(${build}/embedded_bank)
message(STATUS "${PART}: ${output}")
run(${build}/robot_loop ${WORK}/bank.h5 1)
message(STATUS "${PART}: ${output}")
if(NOT output MATCHES "1000 ticks")
  message(FATAL_ERROR "robot_loop said: ${output}")
endif()
run(${build}/combined ${WORK}/bank.h5)
if(NOT output MATCHES "199 samples predicted, RMSE 0[.]0.*sum to 1[.]000")
  message(FATAL_ERROR "combined said: ${output}")
endif()
run(${build}/identify)
message(STATUS "${PART}: ${output}")

if(PART STREQUAL plain)
  needs_only(${WORK}/plain/embedded_bank "hwy")
  needs_only(${WORK}/plain/robot_loop "hwy|hdf5_serial|crypto")
  # Ceres may be a static library; then its own dependencies are needed, too.
  needs_only(${WORK}/plain/identify "hwy|tbb|fmt|ceres|glog|gflags|cholmod|cxsparse|spqr|lapack|blas|f77blas")
endif()
