# fuzz.build builds the fuzzers; fuzz.<name> runs one over its corpus and a number of new
# inputs that takes seconds, always the same ones; fuzz.<name>.long for a minute, over
# others each time.
find_program(CLANGXX clang++)
find_program(BASH bash REQUIRED)
if(NOT CLANGXX)
  message(WARNING "clang++ is not here (see scripts/bootstrap): nothing is fuzzed")
  return()
endif()

script_test(fuzz.build COMMAND sanitize address --fuzzers
            PROPERTIES LABELS fuzz FIXTURES_SETUP fuzzers
                       RESOURCE_LOCK asan_build TIMEOUT 1800 COST 1000)

# fuzz_test(<name> <label> <fuzzer> <option of libFuzzer> ...)
function(fuzz_test name label fuzzer)
  add_test(NAME ${name} COMMAND ${BASH} ${CMAKE_CURRENT_SOURCE_DIR}/run.sh
                                ${PROJECT_SOURCE_DIR}/build/asan/bin/fuzz_${fuzzer}
                                ${CMAKE_CURRENT_SOURCE_DIR}/corpus/${fuzzer} ${ARGN})
  set_tests_properties(${name} PROPERTIES LABELS ${label} FIXTURES_REQUIRED fuzzers
                                          TIMEOUT 900)
endfunction()

# New inputs for each that take a few seconds on a free core.
set(runs_of_cloud_file 2000)
set(runs_of_configuration 1000)
set(runs_of_motion_file 3000)
set(runs_of_posterior_file 2000)
set(runs_of_registration 100)
set(runs_of_result_file 2000)
foreach(fuzzer IN LISTS fuzzers)
  fuzz_test(fuzz.${fuzzer} fuzz ${fuzzer} -seed=1 -runs=${runs_of_${fuzzer}})
  fuzz_test(fuzz.${fuzzer}.long long ${fuzzer} -max_total_time=60)
endforeach()
