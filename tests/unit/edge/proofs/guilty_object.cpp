// Guilty object: everything that the object proofs forbid, to show that they find it. Compiled,
// never run.
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <stdexcept>
#include <string>

namespace guilty {

void* takes_from_malloc(std::size_t size) { return std::malloc(size); }
int* takes_from_new(int value) { return new int(value); }
std::string doubles(const std::string& text) { return text + text; }
int calls_through(const std::function<int(int)>& function) { return function(3); }
void throws() { throw std::runtime_error("no"); }
void prints(std::FILE* file) { std::fprintf(file, "%d", 3); }
double multiplies(double a, double b) { return a * b; }
float adds(float a, float b) { return a + b; }
int converts(double a) { return static_cast<int>(a); }
bool compares(double a, double b) { return a < b; }

}  // namespace guilty
