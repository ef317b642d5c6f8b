/** \file
 * \brief The folders of files to be written.
 */
#pragma once

#include <string>

namespace bayesian_icp::io {

/** \brief The folder that a file of this name is in; "." for a bare name. */
std::string
folderOf(const std::string& file);

/** \brief Make a folder, and those that it is in, where they are missing.
 * \throws FileError if that fails */
void
makeFolder(const std::string& folder);

} // namespace bayesian_icp::io
