# Debian packages: cpack -G DEB in the build folder writes one for each part, each of an install
# component. That of the shared libraries is called by their soname, as Debian does it.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME pcl-bayesian-icp)
file(STRINGS ${PROJECT_SOURCE_DIR}/package.xml maintainer REGEX "<maintainer ")
string(REGEX REPLACE ".*email=\"(.*)\">(.*)</.*" "\\2 <\\1>" CPACK_PACKAGE_CONTACT
                     "${maintainer}")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_PRIORITY optional)
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS ${CMAKE_LIBRARY_OUTPUT_DIRECTORY})

# debian_package(<component> <package> <section> <description>)
macro(debian_package component package section description)
  string(TOUPPER ${component} key)
  set(CPACK_DEBIAN_${key}_PACKAGE_NAME ${package})
  set(CPACK_DEBIAN_${key}_PACKAGE_SECTION ${section})
  # cpack puts CPACK_PACKAGE_DESCRIPTION_SUMMARY before it, as the first line.
  set(CPACK_COMPONENT_${key}_DESCRIPTION
      "Bayesian ICP registers two point clouds by the iterative closest point method
and samples the posterior of the pose: its mean, its covariance and whether
these can be trusted.

${description}")
  list(APPEND CPACK_COMPONENTS_ALL ${component})
endmacro()

set(so_version ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
set(library_package libpcl-bayesian-icp${so_version})
set(library_dependency
    "${library_package} (= ${PROJECT_VERSION}-${CPACK_DEBIAN_PACKAGE_RELEASE})")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "registration of point clouds with a covariance")
set(CPACK_COMPONENTS_ALL)

debian_package(runtime ${library_package} libs "This package has the shared libraries.")
set(control ${PROJECT_BINARY_DIR}/debian)
file(WRITE ${control}/triggers "activate-noawait ldconfig\n")
file(
  WRITE ${control}/shlibs
  "libpcl_bayesian_icp ${so_version} ${library_package} (>= ${PROJECT_VERSION})\n"
  "libpcl_bayesian_icp_core ${so_version} ${library_package} (>= ${PROJECT_VERSION})\n")
set(CPACK_DEBIAN_RUNTIME_PACKAGE_CONTROL_EXTRA ${control}/triggers ${control}/shlibs)

debian_package(
  development libpcl-bayesian-icp-dev libdevel
  "This package has the C++ headers, and descriptions for CMake and pkg-config.")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SHLIBDEPS OFF)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS
    "${library_dependency}, libeigen3-dev (>= 3.4), libpcl-dev (>= 1.13)")

if(BAYESIAN_ICP_BUILD_APPS)
  debian_package(
    tools pcl-bayesian-icp-tools science
    "This package has the programs, with manual pages and completion for bash.")
  set(CPACK_DEBIAN_TOOLS_PACKAGE_DEPENDS "${library_dependency}")
  # They draw their charts by these, pcl_bayesian_icp_evaluate by Python.
  set(CPACK_DEBIAN_TOOLS_PACKAGE_RECOMMENDS
      "gnuplot-nox | gnuplot, python3-matplotlib, python3-pandas")
endif()

if(TARGET bayesian_icp_python_core)
  debian_package(python python3-bayesian-icp python "This package has the Python module.")
  set(python ${BAYESIAN_ICP_PYTHON_VERSION})
  string(REGEX REPLACE "^3\\.(.*)" "\\1" minor ${python})
  math(EXPR next "${minor} + 1")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS
      "${library_dependency}, python3 (>= ${python}), python3 (<< 3.${next}), python3-numpy")
  # The program of python3 -m bayesian_icp, and the charts of reports.
  set(CPACK_DEBIAN_PYTHON_PACKAGE_RECOMMENDS "pcl-bayesian-icp-tools, gnuplot-nox | gnuplot")
endif()

# What Debian wants otherwise than it is installed elsewhere.
set(CPACK_PRE_BUILD_SCRIPTS ${PROJECT_SOURCE_DIR}/cmake/debian_files.cmake)
set(CPACK_POST_BUILD_SCRIPTS ${PROJECT_SOURCE_DIR}/cmake/debian_trigger.cmake)
include(CPack)
