# What every target of the project has in common: language, warnings, visibility.

# bayesian_icp_configure(<target>): C++17, warnings on, baseline instruction set.
# Never add -march or -m<isa> here: PCL and Eigen types cross the library's border.
function(bayesian_icp_configure target)
  target_compile_features(${target} PRIVATE cxx_std_17)
  set_target_properties(${target} PROPERTIES CXX_EXTENSIONS OFF)
  target_compile_options(
    ${target} PRIVATE $<$<CXX_COMPILER_ID:GNU,Clang>:-Wall -Wextra -Wpedantic -Wshadow
                      -Wconversion>
                      $<$<BOOL:${BAYESIAN_ICP_WARNINGS_AS_ERRORS}>:-Werror>
                      # Clang counts signs among the conversions, GCC does not.
                      $<$<CXX_COMPILER_ID:Clang>:-Wno-sign-conversion>
                      # GCC 12 sees array bounds violated where it inlines Eigen's SSE code.
                      $<$<CXX_COMPILER_ID:GNU>:-Wno-array-bounds>)
endfunction()

# bayesian_icp_library(<target> <export name> <file name>): a library of the project with
# hidden symbols by default, a versioned file name and an alias pcl_bayesian_icp::<export name>.
function(bayesian_icp_library target export_name file_name)
  bayesian_icp_configure(${target})
  set_target_properties(
    ${target}
    PROPERTIES EXPORT_NAME ${export_name}
               OUTPUT_NAME ${file_name}
               VERSION ${PROJECT_VERSION}
               SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR}
               CXX_VISIBILITY_PRESET hidden
               VISIBILITY_INLINES_HIDDEN ON
               POSITION_INDEPENDENT_CODE ON)
  if(CMAKE_SYSTEM_NAME STREQUAL "Linux" AND BUILD_SHARED_LIBS)
    set(map ${PROJECT_SOURCE_DIR}/src/exported_symbols.map)
    target_link_options(${target} PRIVATE LINKER:--version-script=${map})
    set_target_properties(${target} PROPERTIES LINK_DEPENDS ${map})
  endif()
  target_compile_features(${target} INTERFACE cxx_std_14)
  target_include_directories(
    ${target} PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include>
                     $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  add_library(pcl_bayesian_icp::${export_name} ALIAS ${target})
endfunction()
