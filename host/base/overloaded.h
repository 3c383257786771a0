// Several lambdas as one visitor: the one whose parameter fits is called.
#pragma once

namespace wavepath {

template <class... Cases>
struct Overloaded : Cases... {
  using Cases::operator()...;
};
template <class... Cases>
Overloaded(Cases...) -> Overloaded<Cases...>;

} // namespace wavepath
