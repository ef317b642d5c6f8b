# A build of the fuzzers alone, docs/fuzzing.md: everything is compiled for libFuzzer with
# AddressSanitizer and UndefinedBehaviorSanitizer, and with assertions.
if(NOT CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
  message(FATAL_ERROR "BAYESIAN_ICP_BUILD_FUZZERS needs Clang, which has libFuzzer: "
                      "-D CMAKE_CXX_COMPILER=clang++")
endif()
set(BUILD_SHARED_LIBS OFF)
add_compile_options(
  -O1
  -UNDEBUG
  -gline-tables-only
  -fsanitize=fuzzer-no-link,address,undefined,float-cast-overflow
  # AddressSanitizer sees the harm of these; without them compiling takes a third less.
  -fno-sanitize=alignment,null,object-size,vptr
  -fno-sanitize-recover=all)
add_link_options(-fsanitize=address,undefined)
# Eigen's own aligned allocation under AddressSanitizer is not that of PCL's libraries.
add_compile_definitions(EIGEN_MALLOC_ALREADY_ALIGNED=1)
