#include "row_file.h"

#include <io/errors.h>
#include <io/output_folder.h>

#include <filesystem>
#include <fstream>

namespace bayesian_icp::evaluate {

RowFile::RowFile(const std::string& name,
                 const std::string& header,
                 const std::function<void(const std::string& row)>& read_row)
: file_(name)
{
  std::ifstream stream(name);
  std::string line;
  const bool exists = stream && std::getline(stream, line);
  if (exists && line != header)
    throw io::FileError(name, "is not a file of results of this version");
  std::string complete = header + '\n';
  bool is_cut_off = false;
  while (exists && std::getline(stream, line) && !(is_cut_off = stream.eof())) {
    try {
      read_row(line);
    }
    catch (const std::exception&) {
      throw io::FileError(name, "bad line '" + line + "'");
    }
    complete += line + '\n';
  }
  stream.close();
  if (!exists || is_cut_off)
    rewrite(complete);
}

void
RowFile::rewrite(const std::string& text) const
{
  const std::filesystem::path path(file_);
  io::OutputFolder folder(path.has_parent_path() ? path.parent_path().string() : ".");
  folder.add(path.filename().string(),
             [&text](std::ostream& stream) { stream << text; });
  folder.commit();
}

void
RowFile::add(const std::string& row) const
{
  std::ofstream stream(file_, std::ios::app);
  if (!(stream << row << '\n' << std::flush))
    throw io::FileError(file_, "cannot be written");
}

} // namespace bayesian_icp::evaluate
