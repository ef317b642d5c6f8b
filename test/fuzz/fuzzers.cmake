# The programs fuzz_<name>. Everything of ours in them is instrumented, and so is what
# PCL, FLANN, Boost and Eigen have in headers. Of the libraries, which the tests use as well,
# libFuzzer sees which code an input reaches, not what is compared there.
target_compile_options(
  bayesian_icp_core_objects PRIVATE -fsanitize-coverage=inline-8bit-counters,pc-table)

find_package(nlohmann_json 3 REQUIRED)
set(apps ${PROJECT_SOURCE_DIR}/apps)
set(evaluation ${PROJECT_SOURCE_DIR}/evaluation)

# What reads files, without the programs around it.
add_library(
  fuzz_readers STATIC EXCLUDE_FROM_ALL
  ${apps}/batch/manifest.cpp
  ${evaluation}/study/scan_pairs.cpp
  ${apps}/io/cloud_file.cpp
  ${apps}/io/folders.cpp
  ${apps}/io/input_file.cpp
  ${apps}/io/json_file.cpp
  ${apps}/io/line_file.cpp
  ${apps}/io/motion.cpp
  ${apps}/io/output_folder.cpp
  ${apps}/io/pcd_format.cpp
  ${apps}/io/ply_format.cpp
  ${apps}/io/posterior_file.cpp
  ${apps}/register/config_file.cpp
  ${apps}/register/settings.cpp
  ${apps}/register/settings_json.cpp
  fuzz_input.cpp)
bayesian_icp_configure(fuzz_readers)
bayesian_icp_use_internals(fuzz_readers)
target_include_directories(fuzz_readers PUBLIC ${apps} ${evaluation})
target_compile_definitions(fuzz_readers PRIVATE BAYESIAN_ICP_VERSION="${PROJECT_VERSION}")
target_compile_options(fuzz_readers PUBLIC -fsanitize=fuzzer-no-link)
target_link_libraries(fuzz_readers PUBLIC nlohmann_json::nlohmann_json pcl_io)

add_custom_target(fuzzers)
foreach(name IN LISTS fuzzers)
  add_executable(fuzz_${name} EXCLUDE_FROM_ALL ${name}_fuzzer.cpp)
  bayesian_icp_configure(fuzz_${name})
  bayesian_icp_use_internals(fuzz_${name})
  target_link_libraries(fuzz_${name} PRIVATE fuzz_readers)
  target_link_options(fuzz_${name} PRIVATE -fsanitize=fuzzer)
  add_dependencies(fuzzers fuzz_${name})
endforeach()

# The class from its headers, and PCL's ICP and search tree as well; FLANN's need lz4.
target_sources(
  fuzz_registration PRIVATE registration_by_descent.cpp registration_checks.cpp
                            registration_input.cpp registration_of_normals.cpp
                            ${evaluation}/paper/monte_carlo_icp.cpp)
target_compile_definitions(fuzz_registration PRIVATE PCL_NO_PRECOMPILE)
target_include_directories(fuzz_registration PRIVATE ${PROJECT_SOURCE_DIR}/include)
target_link_libraries(fuzz_registration PRIVATE pcl_common pcl_kdtree pcl_search
                                                pcl_registration lz4
                                                OpenMP::OpenMP_CXX)

# What belongs to a batch or an evaluation alone.
find_package(Boost REQUIRED COMPONENTS program_options)
target_sources(
  fuzz_result_file
  PRIVATE ${apps}/batch/batch_file.cpp
          ${apps}/register/posterior_files.cpp)
target_compile_definitions(fuzz_result_file
                           PRIVATE BAYESIAN_ICP_VERSION="${PROJECT_VERSION}")
target_link_libraries(fuzz_result_file PRIVATE Boost::program_options)
