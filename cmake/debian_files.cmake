# Run by cpack between installing into a folder for each component and packing these:
# makes of the installed files what Debian's policy asks for.
cmake_minimum_required(VERSION 3.22)
set(source_dir ${CMAKE_CURRENT_LIST_DIR}/..)

# compress(<file>): by gzip, without name and time.
function(compress file)
  execute_process(COMMAND gzip -9nf ${file} COMMAND_ERROR_IS_FATAL ANY)
endfunction()

# write_copyright(<file>): the licence in Debian's machine-readable form.
function(write_copyright file)
  file(STRINGS ${source_dir}/LICENSE lines)
  set(text)
  set(holder)
  foreach(line IN LISTS lines)
    if(line MATCHES "^Copyright \\(c\\) (.*)")
      set(holder "${CMAKE_MATCH_1}")
    elseif(NOT line MATCHES "^(BSD 3-Clause License|All rights reserved.)?$")
      # Clauses and the disclaimer are paragraphs of their own.
      if(line MATCHES "^([123]\\. |THIS SOFTWARE)")
        string(APPEND text " .\n")
      endif()
      string(APPEND text " ${line}\n")
    endif()
  endforeach()
  file(
    WRITE ${file}
    "Format: https://www.debian.org/doc/packaging-manuals/copyright-format/1.0/\n"
    "Upstream-Name: pcl_bayesian_icp\n\n"
    "Files: *\nCopyright: ${holder}\nLicense: BSD-3-clause\n\n"
    "License: BSD-3-clause\n${text}")
endfunction()

# write_changelogs(<folder> <package>): ours, and the one of the packaging.
function(write_changelogs folder package)
  configure_file(${source_dir}/CHANGELOG.md ${folder}/changelog COPYONLY)
  compress(${folder}/changelog)
  set(ENV{LC_ALL} C)
  string(TIMESTAMP now "%a, %d %b %Y %H:%M:%S +0000" UTC)
  file(WRITE ${folder}/changelog.Debian
       "${package} (${CPACK_PACKAGE_VERSION}-${CPACK_DEBIAN_PACKAGE_RELEASE}) unstable; "
       "urgency=medium\n\n  * Package of the release ${CPACK_PACKAGE_VERSION}.\n\n"
       " -- ${CPACK_PACKAGE_CONTACT}  ${now}\n")
  compress(${folder}/changelog.Debian)
endfunction()

foreach(component IN LISTS CPACK_COMPONENTS_ALL)
  set(root ${CPACK_TEMPORARY_DIRECTORY}/${component}${CPACK_PACKAGING_INSTALL_PREFIX})
  string(TOUPPER ${component} key)
  set(package ${CPACK_DEBIAN_${key}_PACKAGE_NAME})
  set(doc ${root}/share/doc/${package})
  file(MAKE_DIRECTORY ${doc})
  # The licence is in the copyright file, the changes are in the changelog.
  if(EXISTS ${root}/share/doc/pcl_bayesian_icp)
    file(RENAME ${root}/share/doc/pcl_bayesian_icp/README.md ${doc}/README.md)
    file(RENAME ${root}/share/doc/pcl_bayesian_icp/docs ${doc}/docs)
    file(REMOVE_RECURSE ${root}/share/doc/pcl_bayesian_icp)
  endif()
  write_copyright(${doc}/copyright)
  write_changelogs(${doc} ${package})

  file(GLOB pages ${root}/share/man/man1/*.1)
  foreach(page IN LISTS pages)
    compress(${page})
  endforeach()
  # Debian's packages are for all versions of Python.
  file(GLOB python_dir ${root}/lib/python3.*)
  if(python_dir)
    file(RENAME ${python_dir} ${root}/lib/python3)
  endif()
  # In /usr the dynamic linker finds the libraries by itself.
  file(GLOB_RECURSE files ${root}/bin/* ${root}/lib/*.so.* ${root}/lib/python3/*.so)
  foreach(file IN LISTS files)
    if(NOT IS_SYMLINK ${file})
      file(RPATH_REMOVE FILE ${file})
    endif()
  endforeach()
endforeach()
