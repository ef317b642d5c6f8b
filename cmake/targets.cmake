# What every target of the project has in common: language, warnings, visibility.

# bayesian_icp_configure(<target>): C++17, warnings on, baseline instruction set.
# Never add -march or -m<isa> here: PCL and Eigen types cross the library's border.
function(bayesian_icp_configure target)
  # In a unity build names in a file's unnamed namespace look as if they were in a header.
  # Clang has no -Wshadow=local. GCC takes a tenth less time if it cleans up its memory less
  # often.
  set(unity_options -Wshadow=local -Wno-subobject-linkage --param=ggc-min-heapsize=1000000)
  set(in_unity_build "$<CXX_COMPILER_ID:GNU>:${unity_options}")
  set(shadow $<IF:$<BOOL:$<TARGET_PROPERTY:UNITY_BUILD>>,$<${in_unity_build}>,-Wshadow>)
  target_compile_features(${target} PRIVATE cxx_std_17)
  set_target_properties(${target} PROPERTIES CXX_EXTENSIONS OFF)
  target_compile_options(
    ${target} PRIVATE $<$<CXX_COMPILER_ID:GNU,Clang>:-Wall -Wextra -Wpedantic -Wconversion>
                      ${shadow}
                      $<$<BOOL:${BAYESIAN_ICP_WARNINGS_AS_ERRORS}>:-Werror>
                      # Clang counts signs among the conversions, GCC does not.
                      $<$<CXX_COMPILER_ID:Clang>:-Wno-sign-conversion>
                      # GCC 12 sees array bounds violated where it inlines Eigen's SSE code.
                      $<$<CXX_COMPILER_ID:GNU>:-Wno-array-bounds>)
endfunction()

# bayesian_icp_objects(<target>): objects of the project's libraries, with hidden symbols.
function(bayesian_icp_objects target)
  bayesian_icp_configure(${target})
  set_target_properties(${target} PROPERTIES CXX_VISIBILITY_PRESET hidden
                                             VISIBILITY_INLINES_HIDDEN ON
                                             POSITION_INDEPENDENT_CODE ON)
  target_include_directories(${target} PRIVATE ${PROJECT_SOURCE_DIR}/include
                                               ${PROJECT_SOURCE_DIR}/src)
endfunction()

# bayesian_icp_library(<name> <file name>): the libraries made of bayesian_icp_<name>_objects.
# - bayesian_icp_<name>, alias pcl_bayesian_icp::<name>: the one that is installed.
# - bayesian_icp_<name>_internal: an archive with everything, and with the headers of src/.
# - bayesian_icp_<name>_linked: what libraries of tools link. It is the archive in a program
#   that uses internals, and the installed library in any other: never both in one program.
function(bayesian_icp_library name file_name)
  set(target bayesian_icp_${name})
  add_library(${target} $<TARGET_OBJECTS:${target}_objects>)
  set_target_properties(
    ${target}
    PROPERTIES EXPORT_NAME ${name}
               OUTPUT_NAME ${file_name}
               LINKER_LANGUAGE CXX
               VERSION ${PROJECT_VERSION}
               SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
  if(CMAKE_SYSTEM_NAME STREQUAL "Linux" AND BUILD_SHARED_LIBS)
    set(map ${PROJECT_SOURCE_DIR}/src/exported_symbols.map)
    target_link_options(${target} PRIVATE LINKER:--version-script=${map})
    set_target_properties(${target} PROPERTIES LINK_DEPENDS ${map})
  endif()
  target_compile_features(${target} INTERFACE cxx_std_14)
  target_include_directories(
    ${target} PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include>
                     $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  add_library(pcl_bayesian_icp::${name} ALIAS ${target})

  if(BUILD_SHARED_LIBS)
    add_library(${target}_internal STATIC EXCLUDE_FROM_ALL $<TARGET_OBJECTS:${target}_objects>)
    set_target_properties(${target}_internal PROPERTIES LINKER_LANGUAGE CXX)
    set(scope PUBLIC)
  else()
    add_library(${target}_internal INTERFACE)
    target_link_libraries(${target}_internal INTERFACE ${target})
    set(scope INTERFACE)
  endif()
  target_include_directories(${target}_internal ${scope} ${PROJECT_SOURCE_DIR}/include
                                                         ${PROJECT_SOURCE_DIR}/src)
  add_library(${target}_linked INTERFACE)
  set(uses_internals $<BOOL:$<TARGET_PROPERTY:BAYESIAN_ICP_INTERNALS>>)
  target_link_libraries(${target}_linked
                        INTERFACE $<IF:${uses_internals},${target}_internal,${target}>)
endfunction()

# bayesian_icp_use_internals(<target>): lets tests, studies and benchmarks reach src/.
function(bayesian_icp_use_internals target)
  set_target_properties(${target} PROPERTIES BAYESIAN_ICP_INTERNALS ON)
  target_link_libraries(${target} PRIVATE bayesian_icp_core_linked)
endfunction()
