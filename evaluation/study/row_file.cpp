#include "study/row_file.h"

#include "io/errors.h"

namespace bayesian_icp::evaluate {

RowFile::RowFile(const std::string& name,
                 const std::string& header,
                 const std::function<void(const std::string& row)>& read_row)
: file_(name, [&, has_header = false](const std::string& line) mutable {
  if (!has_header && line != header)
    throw io::FileError(name, "is not a file of results of this version");
  try {
    if (has_header)
      read_row(line);
  }
  catch (const std::exception&) {
    throw io::FileError(name, "bad line '" + line + "'");
  }
  has_header = true;
})
{
  if (file_.isNew())
    file_.add(header);
}

void
RowFile::add(const std::string& row) const
{
  file_.add(row);
}

} // namespace bayesian_icp::evaluate
