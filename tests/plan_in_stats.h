// A decision of the plan in a stats document.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

namespace wavepath::test {

// Null where the plan has none of that name.
template <class Json>
Json decision_in(const Json& stats, const std::string& what) {
  for (const Json& decision : stats.at("plan"))
    if (decision.at("what") == what) return decision;
  return nullptr;
}

} // namespace wavepath::test
