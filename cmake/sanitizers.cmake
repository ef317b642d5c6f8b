# BAYESIAN_ICP_SANITIZER: every target of the build watched by a sanitizer. The presets asan
# and tsan of CMakePresets.json set it, and what the programs need when they run.
set(BAYESIAN_ICP_SANITIZER "" CACHE STRING
    "Sanitizer: address (with undefined behaviour), thread, or empty for none")
set_property(CACHE BAYESIAN_ICP_SANITIZER PROPERTY STRINGS "" address thread)

if(BAYESIAN_ICP_SANITIZER STREQUAL address)
  set(sanitizer_options -fsanitize=address,undefined,float-cast-overflow
                        -fno-sanitize-recover=all)
  if(CMAKE_CXX_COMPILER_ID STREQUAL Clang)
    list(APPEND sanitizer_options
         -fsanitize-ignorelist=${PROJECT_SOURCE_DIR}/cmake/undefined_of_others.ignore)
  endif()
  # Eigen would choose another allocator than the PCL of the system was built with: because
  # of the sanitizer, and because this is C++17 where that is C++14.
  add_compile_definitions(EIGEN_MALLOC_ALREADY_ALIGNED=1 EIGEN_HAS_CXX17_OVERALIGN=0
                          _GLIBCXX_ASSERTIONS)
elseif(BAYESIAN_ICP_SANITIZER STREQUAL thread)
  if(NOT CMAKE_CXX_COMPILER_ID STREQUAL Clang)
    message(FATAL_ERROR "BAYESIAN_ICP_SANITIZER=thread needs Clang with its libomp: the "
                        "sanitizer does not see what GCC's libgomp synchronizes")
  endif()
  set(sanitizer_options -fsanitize=thread)
  # The tool of libomp that explains its barriers and tasks to the sanitizer.
  execute_process(COMMAND ${CMAKE_CXX_COMPILER} -print-resource-dir
                  OUTPUT_VARIABLE clang_files OUTPUT_STRIP_TRAILING_WHITESPACE)
  find_library(ARCHER archer PATHS ${clang_files}/../.. NO_DEFAULT_PATH REQUIRED)
  file(WRITE ${PROJECT_BINARY_DIR}/archer.cmake
       "set(ENV{OMP_TOOL_LIBRARIES} \"${ARCHER}\")\n")
  set_property(DIRECTORY APPEND PROPERTY TEST_INCLUDE_FILES ${PROJECT_BINARY_DIR}/archer.cmake)
elseif(BAYESIAN_ICP_SANITIZER)
  message(FATAL_ERROR "BAYESIAN_ICP_SANITIZER=${BAYESIAN_ICP_SANITIZER}: not address, "
                      "thread or empty")
endif()

add_compile_options(${sanitizer_options})
add_link_options(${sanitizer_options})
if(BAYESIAN_ICP_SANITIZER)
  add_compile_options(-fno-omit-frame-pointer)
endif()
