#include "workstation/rl/teacher.h"

#include <bit>
#include <cmath>
#include <cstring>

#include "shared/crc32.h"
#include "workstation/io/file.h"
#include "workstation/io/user_error.h"
#include "workstation/rl/c51.h"

namespace bess {
namespace {

// File: magic, version, then fixed-width little-endian fields, parameters, CRC-32 of all before it.
constexpr std::string_view kMagic = "BESSTCHR";
constexpr std::uint32_t kVersion = 1;
constexpr int kTeacherHidden1 = 256;
constexpr int kTeacherHidden2 = 128;
constexpr std::uint32_t kProvenanceMax = 4096;
constexpr int kAtomsMax = 10'000;
static_assert(std::endian::native == std::endian::little);

class Writer {
 public:
  template <typename T>
  void put(const T& value) {
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
  void put_bytes(const void* data, std::size_t size) {
    bytes_.append(static_cast<const char*>(data), size);
  }
  [[nodiscard]] std::string& bytes() { return bytes_; }

 private:
  std::string bytes_;
};

class Reader {
 public:
  Reader(std::string_view bytes, std::string_view name) : bytes_(bytes), name_(name) {}
  template <typename T>
  T take() {
    T value;
    take_bytes(&value, sizeof value);
    return value;
  }
  void take_bytes(void* data, std::size_t size) {
    if (size > bytes_.size()) fail("{}: teacher file is truncated; train again", name_);
    std::memcpy(data, bytes_.data(), size);
    bytes_.remove_prefix(size);
  }
  [[nodiscard]] bool empty() const { return bytes_.empty(); }

 private:
  std::string_view bytes_;
  std::string_view name_;
};

std::uint32_t crc_of(std::string_view bytes) {
  Crc32 crc;
  crc.add_bytes(bytes.data(), bytes.size());
  return crc.value();
}

bool is_possible(const Support& support) {
  return std::isfinite(support.v_min) && std::isfinite(support.v_max) &&
         support.v_min < support.v_max && support.count >= 2 && support.count <= kAtomsMax;
}

PriceMap take_price_map(Reader& in, std::string_view name) {
  const auto table = in.take<std::array<std::int16_t, kPriceCount>>();
  try {
    return PriceMap(table);
  } catch (const UserError& error) {
    fail("{}: {}", name, error.what());
  }
}

}  // namespace

Method parse_method(std::string_view name) {
  if (name == "c51") return Method::kC51;
  if (name == "dqn") return Method::kDqn;
  fail("unknown method \"{}\": use c51 or dqn", name);
}

std::string_view method_name(Method method) { return method == Method::kC51 ? "c51" : "dqn"; }

MlpShape teacher_shape(Method method, const Support& support) {
  const int outputs = method == Method::kC51 ? kActionCount * support.count : kActionCount;
  return {kNetworkInputs, kTeacherHidden1, kTeacherHidden2, outputs};
}

Matrix Teacher::action_values(const MatrixRef& x, MlpTile& tile) const {
  const ConstMlp mlp(shape, parameters.data());
  Matrix z;
  forward_hidden(mlp, x, tile);
  forward_head(mlp, tile, z);
  if (method == Method::kDqn) return z;
  return risk.is_mean() ? mean_values(support, z) : risk_values(support, z, risk);
}

Action TeacherPolicy::decide(const MarketStep& step, std::size_t, double soc_frac) const {
  write_input(network_context(step, teacher_.price_map), soc_frac, x_.data());
  const Matrix values = teacher_.action_values(x_, tile_);
  return argmax_action(values.data());
}

void save_teacher(const std::filesystem::path& path, const Teacher& teacher) {
  Writer out;
  out.put_bytes(kMagic.data(), kMagic.size());
  out.put(kVersion);
  out.put(static_cast<std::uint32_t>(teacher.method));
  out.put(teacher.support);
  out.put(teacher.shape);
  out.put(teacher.price_map.table());
  const std::string_view provenance =
      std::string_view(teacher.provenance).substr(0, kProvenanceMax);
  out.put(static_cast<std::uint32_t>(provenance.size()));
  out.put_bytes(provenance.data(), provenance.size());
  out.put_bytes(teacher.parameters.data(), sizeof(float) * teacher.parameters.size());
  out.put(crc_of(out.bytes()));
  write_file(path, out.bytes());
}

bool is_teacher_file(const std::filesystem::path& path) {
  return std::string_view(read_file(path)).starts_with(kMagic);
}

Teacher load_teacher(const std::filesystem::path& path) {
  const std::string name = path.string();
  const std::string bytes = read_file(path);
  if (!std::string_view(bytes).starts_with(kMagic)) {
    fail("{}: not a teacher file; make one with 'bess-train train'", name);
  }
  const std::string_view body = std::string_view(bytes).substr(0, bytes.size() - sizeof(uint32_t));
  Reader tail(std::string_view(bytes).substr(body.size()), name);
  Reader in(body.substr(std::min(kMagic.size(), body.size())), name);
  const auto version = in.take<std::uint32_t>();
  if (version != kVersion) {
    fail("{}: teacher file version {}, this program reads {}; train again", name, version,
         kVersion);
  }
  if (tail.take<std::uint32_t>() != crc_of(body)) {
    fail("{}: teacher file is damaged (checksum differs); copy it again or train again", name);
  }
  const auto method_number = in.take<std::uint32_t>();
  const auto support = in.take<Support>();
  // The checksum is right, so this was written by another program; say so before using any of it.
  if (method_number > static_cast<std::uint32_t>(Method::kDqn) || !is_possible(support)) {
    fail("{}: teacher file with an impossible method or value range; train again", name);
  }
  const auto method = static_cast<Method>(method_number);
  const auto shape = in.take<MlpShape>();
  if (!(shape == teacher_shape(method, support))) {
    fail("{}: teacher of another network shape; train again", name);
  }
  const PriceMap price_map = take_price_map(in, name);
  std::string provenance(std::min(in.take<std::uint32_t>(), kProvenanceMax), '\0');
  in.take_bytes(provenance.data(), provenance.size());
  Parameters parameters(shape.parameter_count());
  in.take_bytes(parameters.data(), sizeof(float) * parameters.size());
  if (!in.empty()) fail("{}: teacher file has trailing bytes; train again", name);
  return {method, support, shape, price_map, std::move(parameters), std::move(provenance)};
}

Teacher load_teacher(const std::filesystem::path& path, const Risk& risk) {
  Teacher teacher = load_teacher(path);
  if (teacher.method == Method::kDqn && !risk.is_mean()) {
    fail(
        "{}: a dqn teacher knows means only, not how returns are distributed; train a c51 one for "
        "--risk",
        path.string());
  }
  teacher.risk = risk;
  return teacher;
}

}  // namespace bess
