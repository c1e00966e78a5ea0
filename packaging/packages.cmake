# Content and description of the Debian packages. `make packages` makes one package for each install component:
#   program      modebank: the program, and configurations as examples
#   development  libmodebank-dev: static libraries, public headers, files for find_package, the examples of tests/examples
#   python       python3-modebank: the module, if MODEBANK_PYTHON is ON
set(components program development)
set(package_of_program modebank)
set(package_of_development libmodebank-dev)
set(package_of_python python3-modebank)
if(NOT MODEBANK_BUILD_PROGRAM)
  list(REMOVE_ITEM components program)
endif()
if(TARGET modebank_python)
  list(APPEND components python)
endif()

# The maintainer is the author of the last commit. For a tree without commits the packager sets MODEBANK_MAINTAINER.
set(MODEBANK_MAINTAINER "" CACHE STRING "Maintainer of the packages, NAME <ADDRESS>; empty: the author of the last commit")
function(ask_git variable format)
  execute_process(COMMAND git -C ${PROJECT_SOURCE_DIR} log -1 "--format=${format}" OUTPUT_VARIABLE answer
                  OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
  set(${variable} "${answer}" PARENT_SCOPE)
endfunction()
set(maintainer "${MODEBANK_MAINTAINER}")
if(NOT maintainer)
  ask_git(maintainer "%an <%ae>")
endif()
ask_git(date "%cD")
ask_git(date_s "%ct")
if(NOT date)
  string(TIMESTAMP date "%a, %d %b %Y %H:%M:%S +0000" UTC)
  string(TIMESTAMP date_s "%s" UTC)
endif()

# Only the owner chooses the licence, so the packages contain the licence files of the source tree.
file(GLOB licences LIST_DIRECTORIES false ${PROJECT_SOURCE_DIR}/LICENSE ${PROJECT_SOURCE_DIR}/LICENSE.* ${PROJECT_SOURCE_DIR}/COPYING)
set(licence "")
foreach(file IN LISTS licences)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${file})
  file(READ ${file} text)
  string(APPEND licence "${text}\n")
endforeach()
if(NOT licence)
  set(licence "The source tree of this package has no LICENSE file. Its owner has not stated any terms of use, change or
distribution.\n")
endif()

# Packages of others that are compiled in: as headers, as a static library, or as text (d3). Their terms are in Debian's packages.
set(others libboost-dev libceres-dev libeigen3-dev libfmt-dev libhwy-dev libspdlog-dev nlohmann-json3-dev node-d3-path node-d3-scale)
set(notices "")
foreach(package IN LISTS others)
  if(EXISTS /usr/share/doc/${package}/copyright)
    file(READ /usr/share/doc/${package}/copyright text)
    string(APPEND notices "\n==== ${package}\n\n${text}")
  endif()
endforeach()

set(documents ${CMAKE_BINARY_DIR}/packaging)
foreach(component IN LISTS components)
  set(package ${package_of_${component}})
  configure_file(${CMAKE_CURRENT_LIST_DIR}/copyright.in ${documents}/${package}/copyright @ONLY)
  configure_file(${CMAKE_CURRENT_LIST_DIR}/changelog.in ${documents}/${package}/changelog @ONLY)
  # -n: no time stamp, so equal text gives an equal file.
  execute_process(COMMAND gzip -9nf changelog WORKING_DIRECTORY ${documents}/${package} COMMAND_ERROR_IS_FATAL ANY)
  install(FILES ${documents}/${package}/copyright ${documents}/${package}/changelog.gz DESTINATION share/doc/${package}
          COMPONENT ${component})
endforeach()
if(MODEBANK_BUILD_PROGRAM)
  file(GLOB configurations CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/configs/*.ini)
  install(FILES ${configurations} DESTINATION share/doc/modebank/examples COMPONENT program)
endif()
file(GLOB examples CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/tests/examples/*.[ch]pp ${PROJECT_SOURCE_DIR}/tests/examples/CMakeLists.txt)
install(FILES ${examples} DESTINATION share/doc/libmodebank-dev/examples COMPONENT development)

set(CPACK_GENERATOR DEB)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_ALL ${components})
set(CPACK_COMPONENTS_GROUPING ONE_PER_GROUP)
set(CPACK_PACKAGE_DIRECTORY ${CMAKE_BINARY_DIR}/packages)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_PACKAGE_CONTACT "${maintainer}")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "")
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_COMPRESSION_TYPE xz)

# Debian wants lines of at most 79 letters.
set(what "modebank fits local linear models to a robot's logged runs in sliding windows.
It clusters the models, learns a bank of modes, and judges a multiple-model
filter on held-out runs. Parameters and gains have standard errors.")

set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME modebank)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SUGGESTS "libmodebank-dev")
set(CPACK_DEBIAN_PROGRAM_DESCRIPTION "identifies motion with changing character from logged runs
${what}
.
This package contains the program. Type `modebank demo` to see an example.")

# dpkg-shlibdeps finds no dependencies of static libraries. So this list repeats those of modebank-config.cmake.
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME libmodebank-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SHLIBDEPS OFF)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS
    "libceres-dev (>= 2.1), libeigen3-dev (>= 3.4), libfmt-dev (>= 9), libhdf5-dev (>= 1.10), libhwy-dev (>= 1.0), libssl-dev (>= 3.0), libtbb-dev, pkg-config")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SUGGESTS "cmake, g++, modebank")
set(CPACK_DEBIAN_DEVELOPMENT_DESCRIPTION "motion with changing character: libraries of modebank
${what}
.
This package contains static libraries and headers for C++20. They step a bank
on a robot, judge and learn banks, and load archives. CMake finds them with
find_package(modebank).")

if(TARGET modebank_python)
  # A module runs only with the version of Python for which it was compiled.
  find_package(Python 3 COMPONENTS Interpreter REQUIRED)
  math(EXPR next_minor "${Python_VERSION_MINOR} + 1")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-modebank)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SHLIBDEPS ON)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS
      "python3 (>= 3.${Python_VERSION_MINOR}), python3 (<< 3.${next_minor}), python3-numpy, python3-pandas, python3-h5py")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SUGGESTS "modebank, python3-matplotlib, python3-scipy")
  set(CPACK_DEBIAN_PYTHON_DESCRIPTION "motion with changing character: modebank for Python 3
${what}
.
This package contains the module modebank. Its functions take and return numpy
arrays and pandas frames.")
endif()

include(CPack)

# Builds only the targets that are packed. The files have the date of the commit, so equal trees give equal packages.
add_custom_target(modebank_packages COMMAND ${CMAKE_COMMAND} -E env SOURCE_DATE_EPOCH=${date_s} ${CMAKE_CPACK_COMMAND}
                  WORKING_DIRECTORY ${CMAKE_BINARY_DIR} USES_TERMINAL)
list(TRANSFORM installed_libraries PREPEND modebank_ OUTPUT_VARIABLE packed)
if(MODEBANK_BUILD_PROGRAM)
  list(APPEND packed modebank)
endif()
if(TARGET modebank_python)
  list(APPEND packed modebank_python)
endif()
add_dependencies(modebank_packages ${packed})

if(MODEBANK_BUILD_PROGRAM)
  include(${CMAKE_CURRENT_LIST_DIR}/tarball.cmake)
endif()
