# The searches of KdTree and PointNeighbors, one file for each instruction set, chosen at
# run time. These files alone are compiled with more than the baseline instructions, and
# contain nothing that other code could be linked to. No fused multiply-add: results are
# the same on every processor.
target_sources(bayesian_icp_core_objects PRIVATE search/kd_tree_kernels_plain.cpp)
set(kernel_options -ffp-contract=off)
set_source_files_properties(search/kd_tree_kernels_plain.cpp PROPERTIES COMPILE_OPTIONS
                                                                 "${kernel_options}")

if(CMAKE_SYSTEM_PROCESSOR MATCHES "^(x86_64|AMD64|amd64)$" AND CMAKE_SIZEOF_VOID_P EQUAL 8)
  target_sources(
    bayesian_icp_core_objects PRIVATE search/kd_tree_kernels_sse2.cpp search/kd_tree_kernels_avx2.cpp)
  target_compile_definitions(bayesian_icp_core_objects PRIVATE BAYESIAN_ICP_X86_KERNELS)
  set_source_files_properties(search/kd_tree_kernels_sse2.cpp PROPERTIES COMPILE_OPTIONS
                                                                  "${kernel_options}")
  set_source_files_properties(
    search/kd_tree_kernels_avx2.cpp PROPERTIES COMPILE_OPTIONS "${kernel_options};-mavx2")
endif()
