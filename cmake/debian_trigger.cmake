# Run by cpack when packages are packed: takes out the maintainer scripts that call ldconfig,
# which cpack writes for libraries in any case. Debian's way is the trigger that the package
# has; and without scripts it installs into the root of another system.
cmake_minimum_required(VERSION 3.22)
foreach(package IN LISTS CPACK_PACKAGE_FILES)
  set(content ${CPACK_TEMPORARY_DIRECTORY}/repacked)
  file(REMOVE_RECURSE ${content})
  execute_process(COMMAND dpkg-deb --raw-extract ${package} ${content}
                          COMMAND_ERROR_IS_FATAL ANY)
  if(EXISTS ${content}/DEBIAN/triggers)
    file(REMOVE ${content}/DEBIAN/postinst ${content}/DEBIAN/postrm)
    execute_process(COMMAND dpkg-deb --root-owner-group --build ${content} ${package}
                            OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)
  endif()
endforeach()
