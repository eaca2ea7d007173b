#include "item3d/field/hash_grid.h"

#include "item3d/core/error.h"
#include "item3d/core/parallel.h"
#include "item3d/field/cuda/module.h"

#include <torch/csrc/autograd/custom_function.h>

#include <algorithm>
#include <bit>
#include <cmath>

namespace item3d {
namespace {

constexpr std::int64_t chunk_size = 512;  // points in a thread's chunk

void check_arguments(const HashGrid& grid, const at::Tensor& points, const at::Tensor& table) {
    ITEM3D_CHECK(points.dim() == 2 && points.size(1) == 3 && points.scalar_type() == at::kFloat,
                 c10::str("points must be [P, 3] float32, are ", points.sizes()));
    ITEM3D_CHECK(table.dim() == 2 && table.size(0) == grid.entries() &&
                     table.size(1) == grid.features && table.scalar_type() == at::kFloat,
                 c10::str("table must be [", grid.entries(), ", ", grid.features, "] float32, is ",
                          table.sizes()));
    ITEM3D_CHECK((points.is_cpu() || points.is_cuda()) && points.device() == table.device(),
                 "the hash grid's points and table must be on one device, the CPU or CUDA");
    ITEM3D_CHECK(grid.levels.size() <= max_hash_grid_levels, "levels must be at most 32");
}

Vec3 point_at(const float* points, std::int64_t i) {
    return Vec3(points[3 * i], points[3 * i + 1], points[3 * i + 2]);
}

/// Calls f(level, first, last) for blocks of points, level after level. So the threads work on one
/// level's table at a time, and it stays in their caches.
template <typename F>
void for_each_block(const char* name, const HashGrid& grid, std::int64_t count, const F& f) {
    const std::int64_t blocks = (count + chunk_size - 1) / chunk_size;
    parallel_for(
        name, blocks * static_cast<std::int64_t>(grid.levels.size()),
        [&](std::int64_t i) {
            const std::int64_t first = i % blocks * chunk_size;
            f(static_cast<int>(i / blocks), first, std::min(count, first + chunk_size));
        },
        1);
}

template <int F>
void encode_forward(const HashGrid& grid, const float* points, std::int64_t count,
                    const float* table, float* out) {
    const int width = grid.output_width();
    for_each_block(
        "hash_grid_encode", grid, count, [&](int l, std::int64_t first, std::int64_t last) {
            const HashGridLevel level = grid.levels[static_cast<std::size_t>(l)];
            const float* entries = table + static_cast<std::size_t>(level.first) * F;
            for (std::int64_t i = first; i < last; ++i) {
                encode_level<F>(level, entries, point_at(points, i), out + i * width + l * F);
            }
        });
}

template <int F>
void encode_points_backward(const HashGrid& grid, const float* points, std::int64_t count,
                            const float* table, const float* grad, float* grad_points) {
    const int width = grid.output_width();
    parallel_for("hash_grid_points_backward", count, [&](std::int64_t i) {
        Vec3 sum(0.0f);
        for (std::size_t l = 0; l < grid.levels.size(); ++l) {
            const HashGridLevel& level = grid.levels[l];
            sum += encode_level_point_gradient<F>(
                level, table + static_cast<std::size_t>(level.first) * F, point_at(points, i),
                grad + i * width + static_cast<int>(l) * F);
        }
        for (int c = 0; c < 3; ++c)
            grad_points[3 * i + c] = sum[c];
    });
}

/// A set of small integers that returns the rank of each member. It has little more than a bit for
/// each integer, and so fits into the L1 cache.
class RankedSet {
  public:
    explicit RankedSet(std::size_t size) : words_((size + 63) / 64), before_(words_.size()) {}
    void insert(std::uint32_t value) { words_[value >> 6] |= 1ull << (value & 63); }
    /// Computes the ranks, after the last insertion; returns the number of members.
    std::uint32_t finish() {
        std::uint32_t count = 0;
        for (std::size_t i = 0; i < words_.size(); ++i) {
            before_[i] = count;
            count += population(words_[i]);
        }
        return count;
    }
    std::uint32_t rank(std::uint32_t value) const {
        const std::uint64_t smaller = words_[value >> 6] & ((1ull << (value & 63)) - 1);
        return before_[value >> 6] + population(smaller);
    }
    template <typename F>
    void for_each(const F& f) const {
        for (std::size_t i = 0; i < words_.size(); ++i) {
            for (std::uint64_t rest = words_[i]; rest != 0; rest &= rest - 1) {
                f(static_cast<std::uint32_t>(i * 64) +
                  static_cast<std::uint32_t>(std::countr_zero(rest)));
            }
        }
    }

  private:
    // Without -mpopcnt, std::popcount is a library call. This function is inlined.
    static std::uint32_t population(std::uint64_t x) {
        x -= x >> 1 & 0x5555555555555555ull;
        x = (x & 0x3333333333333333ull) + (x >> 2 & 0x3333333333333333ull);
        x = (x + (x >> 4)) & 0x0f0f0f0f0f0f0f0full;
        return static_cast<std::uint32_t>(x * 0x0101010101010101ull >> 56);
    }

    std::vector<std::uint64_t> words_;
    std::vector<std::uint32_t> before_;
};

/// Computes the table's gradient. Each thread takes whole levels and sums over their points in
/// order, without atomics.
template <int F>
at::Tensor encode_table_backward(const HashGrid& grid, const float* points, std::int64_t count,
                                 const float* grad) {
    const int width = grid.output_width();
    const std::int64_t level_count = static_cast<std::int64_t>(grid.levels.size());
    std::vector<RankedSet> touched;
    for (const HashGridLevel& level : grid.levels)
        touched.emplace_back(level.entries);
    std::vector<std::int64_t> first_row(grid.levels.size() + 1, 0);
    parallel_for(
        "hash_grid_mark", level_count,
        [&](std::int64_t i) {
            const std::size_t l = static_cast<std::size_t>(i);
            const HashGridLevel level = grid.levels[l];
            std::uint32_t entries[8];
            for (std::int64_t p = 0; p < count; ++p) {
                corner_entries(level, locate(level, point_at(points, p)), entries);
                for (const std::uint32_t entry : entries)
                    touched[l].insert(entry);
            }
            first_row[l + 1] = touched[l].finish();
        },
        1);
    for (std::size_t l = 0; l < grid.levels.size(); ++l)
        first_row[l + 1] += first_row[l];

    const std::int64_t rows = first_row.back();
    at::Tensor indices = at::empty({1, rows}, at::kLong);
    at::Tensor values = at::zeros({rows, F}, at::kFloat);
    std::int64_t* index_data = indices.data_ptr<std::int64_t>();
    float* value_data = values.data_ptr<float>();
    parallel_for(
        "hash_grid_table_backward", level_count,
        [&](std::int64_t i) {
            const std::size_t l = static_cast<std::size_t>(i);
            const HashGridLevel level = grid.levels[l];
            std::int64_t* index = index_data + first_row[l];
            touched[l].for_each([&](std::uint32_t entry) {
                *index++ = static_cast<std::int64_t>(level.first) + entry;
            });
            float* level_values = value_data + first_row[l] * F;
            std::uint32_t entries[8];
            float* value[8];
            float weights[8];
            HashGridCell last;
            for (std::int64_t p = 0; p < count; ++p) {
                const HashGridCell cell = locate(level, point_at(points, p));
                if (p == 0 || !cell.is_same_cell(last)) {
                    corner_entries(level, cell, entries);
                    for (int c = 0; c < 8; ++c) {
                        value[c] = level_values + std::size_t{touched[l].rank(entries[c])} * F;
                    }
                    last = cell;
                }
                corner_weights(cell, weights);
                const float* g = grad + p * width + i * F;
                for (int c = 0; c < 8; ++c) {
                    for (int f = 0; f < F; ++f)
                        value[c][f] += weights[c] * g[f];
                }
            }
        },
        1);
    // Rows are unique and in rising order.
    return at::_sparse_coo_tensor_unsafe(indices, values, {grid.entries(), F},
                                         at::TensorOptions().dtype(at::kFloat), true);
}

HashGridParameters cuda_parameters(const HashGrid& grid, const at::Tensor& points,
                                   const at::Tensor& table) {
    HashGridParameters p{};
    std::copy(grid.levels.begin(), grid.levels.end(), p.levels);
    p.level_count = static_cast<int>(grid.levels.size());
    p.entry_width = grid.features;
    p.count = points.size(0);
    p.points = points.const_data_ptr<float>();
    p.table = table.const_data_ptr<float>();
    return p;
}

/// Computes the table's gradient on CUDA. Computes the sums for the whole table, and then selects
/// the rows that points read.
at::Tensor table_backward_on_cuda(const HashGrid& grid, HashGridParameters p, at::Device device) {
    const at::Tensor touched =
        at::zeros({grid.entries()}, at::TensorOptions().dtype(at::kByte).device(device));
    p.touched = touched.data_ptr<std::uint8_t>();
    const at::Tensor sums = cuda::sum_on_device(
        grid.entries() * grid.features, 8 * p.count, device, [&](const Accumulator& accumulator) {
            p.table_gradient = accumulator;
            cuda::run(cuda::field_table().hash_grid_table_backward, p, p.level_count * p.count,
                      device);
        });
    const at::Tensor rows = touched.nonzero().squeeze(1);
    return at::_sparse_coo_tensor_unsafe(
        rows.unsqueeze(0), sums.view({grid.entries(), grid.features}).index_select(0, rows),
        {grid.entries(), grid.features}, at::TensorOptions().dtype(at::kFloat).device(device),
        true);
}

/// Calls f.operator()<F>() for the grid's number of features.
template <typename Function>
auto with_features(int features, const Function& f) {
    switch (features) {
        case 1:
            return f.template operator()<1>();
        case 2:
            return f.template operator()<2>();
        case 4:
            return f.template operator()<4>();
        default:
            return f.template operator()<8>();
    }
}

class EncodeFunction : public torch::autograd::Function<EncodeFunction> {
  public:
    static at::Tensor forward(torch::autograd::AutogradContext* context, const at::Tensor& points,
                              const at::Tensor& table, const HashGrid& grid) {
        const at::Tensor p = points.contiguous();
        const at::Tensor t = table.contiguous();
        at::Tensor out = at::empty({p.size(0), grid.output_width()}, p.options());
        if (p.is_cuda()) {
            HashGridParameters parameters = cuda_parameters(grid, p, t);
            parameters.features = out.data_ptr<float>();
            cuda::run(cuda::field_table().hash_grid, parameters, parameters.level_count * p.size(0),
                      p.device());
        } else {
            with_features(grid.features, [&]<int F>() {
                encode_forward<F>(grid, p.data_ptr<float>(), p.size(0), t.data_ptr<float>(),
                                  out.data_ptr<float>());
            });
        }
        context->save_for_backward({p, t});
        std::vector<std::int64_t> shape{grid.features};
        for (const HashGridLevel& level : grid.levels) {
            shape.insert(shape.end(), {level.resolution, level.first, level.entries, level.hashed});
        }
        context->saved_data["grid"] = shape;
        context->saved_data["needs_points"] = points.requires_grad();
        context->saved_data["needs_table"] = table.requires_grad();
        return out;
    }

    static torch::autograd::variable_list backward(torch::autograd::AutogradContext* context,
                                                   torch::autograd::variable_list grads) {
        const auto saved = context->get_saved_variables();
        const at::Tensor& points = saved[0];
        const at::Tensor& table = saved[1];
        const at::Tensor grad = grads[0].contiguous();
        const std::vector<std::int64_t> shape = context->saved_data["grid"].toIntVector();
        HashGrid grid;
        grid.features = static_cast<int>(shape[0]);
        for (std::size_t i = 1; i < shape.size(); i += 4) {
            grid.levels.push_back({static_cast<int>(shape[i]),
                                   static_cast<std::uint32_t>(shape[i + 1]),
                                   static_cast<std::uint32_t>(shape[i + 2]), shape[i + 3] != 0});
        }
        at::Tensor grad_points, grad_table;
        if (points.is_cuda()) {
            HashGridParameters parameters = cuda_parameters(grid, points, table);
            parameters.feature_gradient = grad.const_data_ptr<float>();
            if (context->saved_data["needs_points"].toBool()) {
                grad_points = at::empty_like(points);
                parameters.point_gradient = grad_points.data_ptr<float>();
                cuda::run(cuda::field_table().hash_grid_points_backward, parameters, points.size(0),
                          points.device());
            }
            if (context->saved_data["needs_table"].toBool())
                grad_table = table_backward_on_cuda(grid, parameters, points.device());
            return {grad_points, grad_table, at::Tensor()};
        }
        with_features(grid.features, [&]<int F>() {
            const float* p = points.data_ptr<float>();
            const float* g = grad.data_ptr<float>();
            const std::int64_t count = points.size(0);
            if (context->saved_data["needs_points"].toBool()) {
                grad_points = at::empty_like(points);
                encode_points_backward<F>(grid, p, count, table.data_ptr<float>(), g,
                                          grad_points.data_ptr<float>());
            }
            if (context->saved_data["needs_table"].toBool()) {
                grad_table = encode_table_backward<F>(grid, p, count, g);
            }
        });
        return {grad_points, grad_table, at::Tensor()};
    }
};

}  // namespace

HashGrid HashGrid::make(int levels, int features, int log2_table_size, int base_resolution,
                        int finest_resolution) {
    ITEM3D_CHECK(levels > 0 && levels <= 32, "levels must be in 1..32");
    ITEM3D_CHECK(features == 1 || features == 2 || features == 4 || features == 8,
                 "features must be 1, 2, 4 or 8");
    ITEM3D_CHECK(log2_table_size > 0 && log2_table_size <= 24, "log2_table_size must be in 1..24");
    ITEM3D_CHECK(base_resolution > 0 && finest_resolution >= base_resolution,
                 "resolutions must rise from base to finest");
    HashGrid grid;
    grid.features = features;
    const double growth =
        levels > 1
            ? std::pow(static_cast<double>(finest_resolution) / base_resolution, 1.0 / (levels - 1))
            : 1.0;
    const std::uint64_t maximum = 1ull << log2_table_size;
    std::uint32_t first = 0;
    for (int i = 0; i < levels; ++i) {
        HashGridLevel level;
        level.resolution = static_cast<int>(std::lround(base_resolution * std::pow(growth, i)));
        const std::uint64_t row = static_cast<std::uint64_t>(level.resolution) + 1;
        level.hashed = row * row * row > maximum;
        level.entries = static_cast<std::uint32_t>(level.hashed ? maximum : row * row * row);
        level.first = first;
        first += level.entries;
        grid.levels.push_back(level);
    }
    return grid;
}

std::int64_t HashGrid::entries() const {
    return levels.empty() ? 0
                          : static_cast<std::int64_t>(levels.back().first) + levels.back().entries;
}

at::Tensor encode(const HashGrid& grid, const at::Tensor& points, const at::Tensor& table) {
    check_arguments(grid, points, table);
    return EncodeFunction::apply(points, table, grid);
}

}  // namespace item3d
