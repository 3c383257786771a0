// The number of members of a plain struct, known to the compiler: a table that lists them can check that it lists all.
#pragma once

#include <cstddef>

namespace wavepath {

// Stands for a value of any type, in expressions that are never evaluated.
struct AnyValue {
  template <class T>
  operator T() const;
};

// Number of values that T's braces take. T has no base class, constructor or array member.
template <class T, class... Values>
consteval std::size_t member_count() {
  if constexpr (requires { T{Values()..., AnyValue()}; })
    return member_count<T, Values..., AnyValue>();
  else
    return sizeof...(Values);
}

} // namespace wavepath
