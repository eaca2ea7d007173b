#include "item3d/render/checks.h"

#include "item3d/core/error.h"

#include <sstream>

namespace item3d {

at::Tensor checked(const char* operation, const char* name, const at::Tensor& tensor,
                   at::ScalarType type, std::initializer_list<std::int64_t> shape,
                   at::Device device) {
    const std::vector<std::int64_t> wanted(shape);
    bool good = tensor.defined() && tensor.device() == device && tensor.scalar_type() == type &&
                tensor.dim() == static_cast<std::int64_t>(wanted.size());
    for (std::size_t i = 0; good && i < wanted.size(); ++i)
        good = wanted[i] < 0 || tensor.size(static_cast<std::int64_t>(i)) == wanted[i];
    if (!good) {
        std::ostringstream message;
        message << operation << ": " << name << " must be a " << at::toString(type)
                << (device.is_cpu() ? " CPU" : " CUDA") << " tensor [";
        for (std::size_t i = 0; i < wanted.size(); ++i)
            message << (i ? ", " : "") << (wanted[i] < 0 ? "*" : std::to_string(wanted[i]));
        message << "], found ";
        if (tensor.defined())
            message << at::toString(tensor.scalar_type()) << " " << tensor.device() << " "
                    << tensor.sizes();
        else
            message << "an undefined tensor";
        throw std::logic_error(message.str());
    }
    return tensor.contiguous();
}

at::Device operation_device(const char* operation, const at::Tensor& tensor) {
    if (!tensor.defined() || !(tensor.is_cpu() || tensor.is_cuda()))
        throw std::logic_error(std::string(operation) +
                               ": expected a tensor on the CPU or on CUDA");
    return tensor.device();
}

}  // namespace item3d
