#include "batch/ranks.h"

namespace bayesian_icp::app {

Ranks::Ranks() = default;

Ranks::~Ranks() = default;

bool
Ranks::hasMpi()
{
  return false;
}

std::vector<std::size_t>
Ranks::broadcast(std::vector<std::size_t> numbers) const
{
  return numbers;
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
