# Documentation that is made from the code: API pages (target `docs`), and man pages and
# bash completion of the installed programs.

# What `man` and `apropos` call each program, or command of a program. A program that is
# installed needs a line here; completion needs none, it asks the program's --help.
set(program_descriptions
    "pcl_bayesian_icp|register two point clouds and say how sure the pose is"
    "pcl_bayesian_icp_simulate|simulate a pair of scans whose true pose is known"
    "pcl_bayesian_icp_transform|move a point cloud by a pose"
    "pcl_bayesian_icp_batch|register many pairs of point clouds, with their posteriors"
    "pcl_bayesian_icp_pose_graph|register scans, close loops and optimize the pose graph"
    "pcl_bayesian_icp_track|the trajectory of a sensor from its scans, with its covariance"
    "pcl_bayesian_icp_viewer|show how sure the pose of two registered point clouds is"
    "pcl_bayesian_icp_evaluate|check whether covariances of registrations are right"
    "pcl_bayesian_icp_evaluate coverage|how often the truth is within the regions of a posterior"
    "pcl_bayesian_icp_evaluate samplers|compare draws of the samplers with a gold standard"
    "pcl_bayesian_icp_evaluate sbc|simulation-based calibration of the samplers"
    "pcl_bayesian_icp_evaluate cycles|whether a pose graph's cycles close within its covariances"
    "pcl_bayesian_icp_evaluate trajectories|whether covariances make trajectories better"
    "pcl_bayesian_icp_evaluate paper|the paper's whole evaluation and a report"
    "pcl_bayesian_icp_evaluate distribution|divergence of every method from Monte Carlo ICP"
    "pcl_bayesian_icp_evaluate samples|divergence as a function of the number of draws"
    "pcl_bayesian_icp_evaluate burn-in|divergence as a function of the length of burn-in"
    "pcl_bayesian_icp_evaluate runtime|seconds per 1000 draws"
    "pcl_bayesian_icp_evaluate accuracy|errors of posterior means, SGD-ICP and ICP"
    "pcl_bayesian_icp_evaluate report|make a report of a study's CSV files")

find_program(DOXYGEN doxygen)
if(DOXYGEN AND IS_TOP_LEVEL)
  configure_file(${PROJECT_SOURCE_DIR}/docs/Doxyfile.in ${PROJECT_BINARY_DIR}/docs/Doxyfile
                 @ONLY)
  add_custom_target(
    docs
    COMMAND ${DOXYGEN} ${PROJECT_BINARY_DIR}/docs/Doxyfile
    COMMENT "Writing ${PROJECT_BINARY_DIR}/docs/html/index.html"
    VERBATIM)
endif()

# Pages are made by running the programs, where these can run.
find_program(HELP2MAN help2man)
if(NOT HELP2MAN AND installed_programs)
  message(STATUS "help2man is not here (see scripts/bootstrap): no man pages")
endif()
set(make_man_page ${PROJECT_SOURCE_DIR}/cmake/make_man_page.sh)
set(man_pages)
foreach(entry IN LISTS program_descriptions)
  string(REGEX MATCH "^([a-z_]+)([^|]*)\\|(.*)$" matched "${entry}")
  set(program ${CMAKE_MATCH_1})
  set(command "${CMAKE_MATCH_2}")
  set(description "${CMAKE_MATCH_3}")
  if(HELP2MAN AND NOT CMAKE_CROSSCOMPILING AND program IN_LIST installed_programs)
    string(REPLACE " " "-" page "${program}${command}.1")
    set(page ${PROJECT_BINARY_DIR}/man/${page})
    separate_arguments(words UNIX_COMMAND "${command}")
    add_custom_command(
      OUTPUT ${page}
      COMMAND bash ${make_man_page} ${HELP2MAN} ${page} ${PROJECT_VERSION} ${description}
              ${program} ${words}
      WORKING_DIRECTORY $<TARGET_FILE_DIR:${program}>
      DEPENDS ${program} ${make_man_page}
      VERBATIM)
    list(APPEND man_pages ${page})
  endif()
endforeach()
if(man_pages)
  file(MAKE_DIRECTORY ${PROJECT_BINARY_DIR}/man)
  add_custom_target(bayesian_icp_man ALL DEPENDS ${man_pages})
  install(
    FILES ${man_pages}
    DESTINATION ${CMAKE_INSTALL_MANDIR}/man1
    COMPONENT tools)
endif()

# Bash loads the file that is called as the program.
foreach(program IN LISTS installed_programs)
  install(
    FILES ${PROJECT_SOURCE_DIR}/scripts/bash_completion
    DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions
    COMPONENT tools
    RENAME ${program})
endforeach()
