#include "batch/ranks.h"

namespace bayesian_icp::app {

Ranks::Ranks() = default;

Ranks::~Ranks() = default;

bool
Ranks::hasMpi()
{
  return false;
}

std::string
Ranks::broadcast(const std::string& text) const
{
  return text;
}

int
Ranks::maximum(int value) const
{
  return value;
}

void
Ranks::abort(int) const
{}

} // namespace bayesian_icp::app
