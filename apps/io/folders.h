/** \file
 * \brief The folders of files to be written.
 */
#pragma once

#include <string>
#include <vector>

namespace bayesian_icp::io {

/** \brief The folder that a file of this name is in; "." for a bare name. */
std::string
folderOf(const std::string& file);

/** \brief Whether both names are of one file that exists. */
bool
isSameFile(const std::string& a, const std::string& b);

/** \brief Make a folder, and those that it is in, where they are missing.
 * \throws FileError if that fails */
void
makeFolder(const std::string& folder);

/** \brief A sequence of scans: the .pcd files of a folder by name, or the files
 * themselves.
 * \param[in] arguments one folder, or files in their order
 * \throws UsageError if these are fewer than two files, FileError if the folder cannot
 *         be read, has fewer than two, or has numbered ones that names do not sort */
std::vector<std::string>
scansOf(const std::vector<std::string>& arguments);

} // namespace bayesian_icp::io
