# `make dist` writes modebank-VERSION-linux-PROCESSOR.tar.gz: the component program, and in lib/ the libraries that it needs.
# glibc is not included, because its libraries fit only the loader of the same system.
# The program has a DT_RPATH. The loader uses a DT_RPATH, unlike a DT_RUNPATH, also for libraries that other libraries need. It
# searches the DT_RPATH before LD_LIBRARY_PATH, in which ROS has other versions. A library's own DT_RUNPATH would disable the
# program's DT_RPATH for this library, so the libraries have none.
# CMake's INSTALL_RPATH would also change the Debian package, in which Debian forbids it. patchelf changes only the tarball's copy.
install(CODE [[
  file(GET_RUNTIME_DEPENDENCIES EXECUTABLES "$<TARGET_FILE:modebank>" RESOLVED_DEPENDENCIES_VAR libraries
       PRE_EXCLUDE_REGEXES "^ld-linux" "^lib(anl|c|dl|m|mvec|nsl|pthread|resolv|rt|util)\\.so")
  set(root "${CMAKE_INSTALL_PREFIX}")
  foreach(library IN LISTS libraries)
    # `name` is the name that the loader looks for, `file` the file behind it: BLAS and LAPACK are links to this machine's choice.
    get_filename_component(name "${library}" NAME)
    get_filename_component(file "${library}" REALPATH)
    file(COPY_FILE "${file}" "${root}/lib/${name}")
    execute_process(COMMAND patchelf --remove-rpath "${root}/lib/${name}" COMMAND_ERROR_IS_FATAL ANY)
    # The terms of a library are those of its package. dpkg lists some files by a name without /usr.
    string(REGEX REPLACE "^/usr/" "/" unmerged "${file}")
    execute_process(COMMAND dpkg-query --search "${file}" "${unmerged}" OUTPUT_VARIABLE package ERROR_QUIET)
    string(REGEX REPLACE ":.*" "" package "${package}")
    if(NOT package)
      message(FATAL_ERROR "${file} comes from no Debian package: the tarball cannot state its licence")
    endif()
    configure_file(/usr/share/doc/${package}/copyright "${root}/share/doc/modebank/libraries/${package}" COPYONLY)
  endforeach()
  # The terms refer to these licence texts.
  file(COPY /usr/share/common-licenses DESTINATION "${root}/share/doc/modebank/libraries")
  execute_process(COMMAND patchelf --force-rpath --set-rpath "$ORIGIN/../lib" "${root}/bin/modebank" COMMAND_ERROR_IS_FATAL ANY)
]] COMPONENT tarball EXCLUDE_FROM_ALL)

set(tarball modebank-${PROJECT_VERSION}-linux-${CMAKE_SYSTEM_PROCESSOR})
set(staged ${CMAKE_BINARY_DIR}/tarball)
add_custom_target(modebank_dist DEPENDS modebank
  COMMAND ${CMAKE_COMMAND} -E rm -rf ${staged}
  COMMAND ${CMAKE_COMMAND} --install ${CMAKE_BINARY_DIR} --component program --strip --prefix ${staged}/${tarball}
  COMMAND ${CMAKE_COMMAND} -E make_directory ${staged}/${tarball}/lib
  COMMAND ${CMAKE_COMMAND} --install ${CMAKE_BINARY_DIR} --component tarball --prefix ${staged}/${tarball}
  # The files have the date of the commit, so equal trees give equal tarballs.
  COMMAND tar --create --gzip --sort=name --owner=0 --group=0 --numeric-owner --mode=u+rw,go=rX --mtime=@${date_s} --file=${tarball}.tar.gz -C ${staged} ${tarball}
  WORKING_DIRECTORY ${CMAKE_BINARY_DIR} VERBATIM)
