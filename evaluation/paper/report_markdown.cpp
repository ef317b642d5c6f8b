#include "paper/report_document.h"

#include <ostream>

namespace bayesian_icp::evaluate {

namespace {

/** Text of a table's cell. */
std::string
cellOf(const std::string& text)
{
  std::string cell;
  for (const char character : text)
    cell += character == '|' ? std::string("\\|") : std::string(1, character);
  return cell;
}

void
writeRow(const std::vector<std::string>& cells, std::ostream& stream)
{
  stream << '|';
  for (const std::string& cell : cells)
    stream << ' ' << cellOf(cell) << " |";
  stream << '\n';
}

struct BlockWriter {
  std::ostream& stream;

  void
  operator()(const ReportText& block) const
  {
    stream << block.text << '\n';
  }

  void
  operator()(const ReportCode& block) const
  {
    stream << "```\n"
           << block.text << (block.text.back() == '\n' ? "" : "\n") << "```\n";
  }

  void
  operator()(const ReportTable& table) const
  {
    stream << table.caption << "\n\n";
    writeRow(table.header, stream);
    stream << "|---|";
    for (std::size_t i = 1; i < table.header.size(); ++i)
      stream << "--:|";
    stream << '\n';
    for (const auto& row : table.rows)
      writeRow(row, stream);
  }

  void
  operator()(const ReportFigure& figure) const
  {
    stream << "![" << figure.caption << "](" << figure.file << ".svg)\n";
  }
};

} // namespace

void
writeMarkdown(const ReportSection& section, std::ostream& stream)
{
  stream << "## " << section.title << '\n';
  for (const ReportBlock& block : section.blocks) {
    stream << '\n';
    std::visit(BlockWriter{stream}, block);
  }
}

void
writeMarkdown(const ReportDocument& document, std::ostream& stream)
{
  stream << "# " << document.title << '\n';
  for (const ReportSection& section : document.sections) {
    stream << '\n';
    writeMarkdown(section, stream);
  }
}

} // namespace bayesian_icp::evaluate
