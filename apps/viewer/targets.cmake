# pcl_bayesian_icp_viewer. What it shows is computed without VTK; only the program needs it.
add_library(
  bayesian_icp_viewer_scene STATIC
  viewer/geometry/camera.cpp
  viewer/geometry/pose_spread.cpp
  viewer/legend.cpp
  viewer/live_state.cpp
  viewer/scene.cpp
  viewer/view_options.cpp)
bayesian_icp_configure(bayesian_icp_viewer_scene)
target_link_libraries(bayesian_icp_viewer_scene PUBLIC bayesian_icp_app_io)

find_package(PCL 1.13 QUIET COMPONENTS visualization)
find_package(X11 QUIET)
if(PCL_VISUALIZATION_FOUND AND X11_FOUND)
  set(viewer_default ON)
else()
  set(viewer_default OFF)
endif()
option(BAYESIAN_ICP_BUILD_VIEWER
       "Build pcl_bayesian_icp_viewer (needs PCL's visualization, VTK and X11)"
       ${viewer_default})
if(BAYESIAN_ICP_BUILD_VIEWER)
  if(NOT viewer_default)
    message(FATAL_ERROR "BAYESIAN_ICP_BUILD_VIEWER needs PCL's visualization and X11")
  endif()
  add_executable(
    pcl_bayesian_icp_viewer
    viewer/annotations.cpp
    viewer/command_line.cpp
    viewer/display.cpp
    viewer/drawing.cpp
    viewer/live_view.cpp
    viewer/main.cpp
    viewer/window.cpp)
  # X11's macros would change what is compiled with it.
  set_source_files_properties(viewer/display.cpp PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
  bayesian_icp_configure(pcl_bayesian_icp_viewer)
  target_link_libraries(
    pcl_bayesian_icp_viewer PRIVATE bayesian_icp_app_register bayesian_icp_viewer_scene
                                    pcl_visualization X11::X11)
endif()
