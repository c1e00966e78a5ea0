# The reference tests under each x86 instruction set of the vector kernels. SCALAR also runs with the libm of a machine without AVX2 and
# FMA. A machine that lacks a set has none of its tests. They are left out under sanitizers, which must be preloaded first.
if(MODEBANK_SANITIZERS OR NOT CMAKE_SYSTEM_PROCESSOR MATCHES "^(x86_64|AMD64)$")
  return()
endif()

add_library(instruction_set MODULE support/instruction_set.cpp)
target_link_libraries(instruction_set PRIVATE PkgConfig::highway modebank_build)

file(STRINGS /proc/cpuinfo flags REGEX "^flags" LIMIT_COUNT 1)
set(machine_sets SCALAR)
if(flags MATCHES " avx2 ")
  list(APPEND machine_sets AVX2)
endif()
if(flags MATCHES " avx512vl ")
  list(APPEND machine_sets AVX3)
endif()

function(modebank_instruction_sets test label filter)
  foreach(set ${machine_sets})
    set(environment LD_PRELOAD=$<TARGET_FILE:instruction_set> MODEBANK_TEST_INSTRUCTION_SET=${set})
    if(set STREQUAL SCALAR)
      list(APPEND environment GLIBC_TUNABLES=glibc.cpu.hwcaps=-AVX2,-FMA)
    endif()
    add_test(NAME InstructionSet.${set}.${test} COMMAND test_${test} --gtest_filter=${filter})
    set_tests_properties(InstructionSet.${set}.${test} PROPERTIES
      LABELS ${label} TIMEOUT 600 SKIP_RETURN_CODE 77 ENVIRONMENT "${environment}")
    add_dependencies(test_${test} instruction_set)
  endforeach()
endfunction()

modebank_instruction_sets(ident short "*Batch.EveryWindowIsAt*/huber_*:*Batch.EveryWindowIsAt*/tukey_*")
modebank_instruction_sets(mixture short "MixtureGolden.*:Mclust.*")
