# What cmake --install puts where: libraries, headers, tools, and the descriptions by which
# CMake, pkg-config and ROS find them. Everything found from an installed file is relative
# to that file, so the prefix can be moved. The components are those of the Debian packages
# (cmake/debian.cmake); cmake --install puts all of them.
include(CMakePackageConfigHelpers)

set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/pcl_bayesian_icp)
set(pkgconfig_dir ${CMAKE_INSTALL_LIBDIR}/pkgconfig)

# Libraries find each other beside themselves, tools find them from the bin folder.
file(RELATIVE_PATH libraries_from_tools ${CMAKE_INSTALL_FULL_BINDIR}
     ${CMAKE_INSTALL_FULL_LIBDIR})
set_target_properties(bayesian_icp_core bayesian_icp_pcl PROPERTIES INSTALL_RPATH "$ORIGIN")

# One export per component: who asks for `core` alone never loads a target that needs PCL.
foreach(component core pcl)
  install(
    TARGETS bayesian_icp_${component} EXPORT pcl_bayesian_icp-${component}
    LIBRARY COMPONENT runtime NAMELINK_COMPONENT development
    ARCHIVE COMPONENT development)
  install(
    EXPORT pcl_bayesian_icp-${component}
    NAMESPACE pcl_bayesian_icp::
    DESTINATION ${package_dir}
    COMPONENT development)
endforeach()
install(
  DIRECTORY ${PROJECT_SOURCE_DIR}/include/
  DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}
  COMPONENT development)

# Tools are the programs of apps/ and evaluation/ that carry the project's name.
set(installed_programs)
if(BAYESIAN_ICP_BUILD_APPS)
  get_directory_property(app_targets DIRECTORY ${PROJECT_SOURCE_DIR}/apps BUILDSYSTEM_TARGETS)
  if(BAYESIAN_ICP_BUILD_EVALUATION)
    list(APPEND app_targets pcl_bayesian_icp_evaluate)
  endif()
  foreach(app IN LISTS app_targets)
    get_target_property(type ${app} TYPE)
    if(type STREQUAL "EXECUTABLE" AND app MATCHES "^pcl_bayesian_icp")
      set_target_properties(${app} PROPERTIES INSTALL_RPATH "$ORIGIN/${libraries_from_tools}")
      install(TARGETS ${app} RUNTIME COMPONENT tools)
      list(APPEND installed_programs ${app})
    endif()
  endforeach()
endif()

configure_package_config_file(
  ${PROJECT_SOURCE_DIR}/cmake/pcl_bayesian_icpConfig.cmake.in
  ${PROJECT_BINARY_DIR}/pcl_bayesian_icpConfig.cmake
  INSTALL_DESTINATION ${package_dir}
  NO_SET_AND_CHECK_MACRO)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/pcl_bayesian_icpConfigVersion.cmake
                                 COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/pcl_bayesian_icpConfig.cmake
              ${PROJECT_BINARY_DIR}/pcl_bayesian_icpConfigVersion.cmake
        DESTINATION ${package_dir} COMPONENT development)

file(RELATIVE_PATH prefix_from_pkgconfig ${CMAKE_INSTALL_FULL_LIBDIR}/pkgconfig
     ${CMAKE_INSTALL_PREFIX})
file(RELATIVE_PATH includes_from_pkgconfig ${CMAKE_INSTALL_FULL_LIBDIR}/pkgconfig
     ${CMAKE_INSTALL_FULL_INCLUDEDIR})
foreach(name pcl_bayesian_icp_core pcl_bayesian_icp)
  configure_file(${PROJECT_SOURCE_DIR}/cmake/${name}.pc.in ${PROJECT_BINARY_DIR}/${name}.pc
                 @ONLY)
  install(
    FILES ${PROJECT_BINARY_DIR}/${name}.pc
    DESTINATION ${pkgconfig_dir}
    COMPONENT development)
endforeach()

install(FILES ${PROJECT_SOURCE_DIR}/package.xml
        DESTINATION ${CMAKE_INSTALL_DATADIR}/pcl_bayesian_icp COMPONENT development)
install(FILES ${PROJECT_SOURCE_DIR}/README.md ${PROJECT_SOURCE_DIR}/LICENSE
              ${PROJECT_SOURCE_DIR}/CHANGELOG.md DESTINATION ${CMAKE_INSTALL_DOCDIR}
        COMPONENT development)
# The pages that README.md links to, with their pictures.
install(
  DIRECTORY ${PROJECT_SOURCE_DIR}/docs
  DESTINATION ${CMAKE_INSTALL_DOCDIR}
  COMPONENT development
  FILES_MATCHING
  PATTERN "*.md"
  PATTERN "*.png")
