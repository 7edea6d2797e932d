// Converts arguments of Python functions to values of the core, for the Python modules of all packages.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_common/config_blocks.h>
#include <ddm_common/image_codec.h>
#include <ddm_common/option_checks.h>
#include <ddm_common/yaml_text.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <yaml-cpp/yaml.h>

#include <Eigen/Core>
#include <algorithm>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

namespace ddm {

namespace py = pybind11;

/// Describes an argument for an error message: "float64 [3 x 2]" for an array, else its type.
inline std::string describe(const py::handle& value) {
  if (!py::isinstance<py::array>(value)) {
    return value.get_type().attr("__name__").cast<std::string>();
  }
  const auto array = py::reinterpret_borrow<py::array>(value);
  std::string sizes;
  for (Eigen::Index i = 0; i < array.ndim(); ++i) {
    sizes += (i > 0 ? " x " : "") + std::to_string(array.shape(i));
  }
  return py::str(array.dtype()).cast<std::string>() + " [" + sizes + "]";
}

/// "torque must be an array [2] of finite numbers"
inline std::string ruleOf(const std::string& name, const std::string& shape, const char* elements) {
  return name + " must be an array " + shape + " of " + elements;
}

/// Converts an argument to an array of `Number`, without a copy if it is one.
/// @param kinds  accepted kinds of numpy.dtype
/// @throws py::type_error naming the argument if its elements have another type
template <class Number>
py::array_t<Number, py::array::c_style> arrayOf(const py::handle& value, const std::string& name,
                                                const std::string& shape, const char* elements,
                                                const char* kinds) {
  using Array = py::array_t<Number, py::array::c_style>;
  if (py::isinstance<Array>(value)) return py::reinterpret_borrow<Array>(value);
  const py::array any = py::array::ensure(value);
  const bool accepted =
      any && std::string(kinds).find(any.dtype().kind()) != std::string::npos &&
      (any.dtype().kind() == 'f' || static_cast<std::size_t>(any.itemsize()) <= sizeof(Number));
  if (!accepted) {
    throw py::type_error(ruleOf(name, shape, elements) + ", got " + describe(any ? any : value));
  }
  return py::array_t<Number, py::array::c_style | py::array::forcecast>(any);
}

/// Converts an argument to finite numbers.
/// @param shape  "[T x 2]": samples, one per row, each with `dim` numbers; "[2]": one sample
/// @param dim    numbers of a sample; -1: any number, but at least one
/// @return       one sample per column  [dim x T]
/// @throws py::type_error or py::value_error naming argument, value and rule
inline Eigen::MatrixXd numbersOf(const py::handle& value, const std::string& name,
                                 const std::string& shape, Eigen::Index dim) {
  constexpr char kElements[] = "finite numbers";
  const auto array = arrayOf<double>(value, name, shape, kElements, "fiu");
  const Eigen::Index num_dims = shape.find('x') == std::string::npos ? 1 : 2;
  const Eigen::Index last = array.ndim() == num_dims ? array.shape(num_dims - 1) : 0;
  if (last == 0 || (dim >= 0 && last != dim)) {
    throw py::value_error(ruleOf(name, shape, kElements) + ", got " + describe(array));
  }
  const Eigen::MatrixXd numbers =
      Eigen::Map<const Eigen::MatrixXd>(array.data(), last, array.size() / last);
  if (numbers.allFinite()) return numbers;
  throw py::value_error(ruleOf(name, shape, kElements) + ", got NaN or infinity");
}

/// Converts an array with one sample per row.  [T x dim]
inline Eigen::MatrixXd samplesOf(const py::handle& value, const std::string& name,
                                 Eigen::Index dim = -1) {
  return numbersOf(value, name, "[T x " + (dim < 0 ? "motors" : std::to_string(dim)) + "]", dim);
}

inline Eigen::VectorXd vectorOf(const py::handle& value, const std::string& name,
                                Eigen::Index dim) {
  return numbersOf(value, name, "[" + std::to_string(dim) + "]", dim);
}

/// Converts an argument to a number of an episode or a seed.
/// @throws py::type_error or py::value_error naming argument, value and rule
template <class Unsigned>
Unsigned wholeOf(const py::handle& value, const std::string& name) {
  const std::string rule = name + " must be a whole number, 0 ... ";
  const auto largest = static_cast<unsigned long long>(std::numeric_limits<Unsigned>::max());
  if (!PyIndex_Check(value.ptr())) {
    throw py::type_error(rule + std::to_string(largest) + ", got " + describe(value));
  }
  const auto index = py::reinterpret_steal<py::object>(PyNumber_Index(value.ptr()));
  const unsigned long long number = index ? PyLong_AsUnsignedLongLong(index.ptr()) : 0;
  if (PyErr_Occurred() != nullptr || number > largest) {
    PyErr_Clear();
    throw py::value_error(rule + std::to_string(largest) + ", got " +
                          py::repr(value).cast<std::string>());
  }
  return static_cast<Unsigned>(number);
}

/// @throws py::value_error naming the argument if the text has characters that UTF-8 cannot encode
inline std::string utf8Of(const py::handle& text, const std::string& name) {
  const char* const bytes = PyUnicode_AsUTF8(text.ptr());
  if (bytes != nullptr) return bytes;
  PyErr_Clear();
  throw py::value_error(
      name + " must be a text that UTF-8 can encode, got " +
      py::str(py::module::import("builtins").attr("ascii")(text)).cast<std::string>());
}

/// Converts a text or a pathlib.Path.
/// @throws py::type_error naming argument, value and rule
inline std::string pathOf(const py::handle& value) {
  const auto path = py::reinterpret_steal<py::object>(PyOS_FSPath(value.ptr()));
  if (path && PyUnicode_Check(path.ptr())) return utf8Of(path, "path");
  PyErr_Clear();
  throw py::type_error("path must be a text or a pathlib.Path, got " + describe(value));
}

/// An array of `shape` with a copy of the values, twice as fast as the copy of pybind11.
template <class Number, class Shape>
py::array_t<Number> copyOf(const Number* values, const Shape& shape) {
  py::array_t<Number> array(shape);
  std::copy(values, values + array.size(), array.mutable_data());
  return array;
}

inline py::array_t<double> arrayOf(const Eigen::VectorXd& vector) {
  return copyOf(vector.data(), vector.size());
}

/// Samples of Eigen, one per column, as an array with one sample per row.
inline py::array_t<double> rowsOf(const Eigen::MatrixXd& columns) {
  return copyOf(columns.data(), std::vector<Eigen::Index>{columns.cols(), columns.rows()});
}

/// Images of one size. Keeps the array of Python and copies an image only when it is used.
class Images {
 public:
  /// @param value  images, uint8 [T x H x W] or [T x H x W x 3] (red, green, blue)
  /// @throws py::type_error or py::value_error naming argument, value and rule
  Images(const py::handle& value, const std::string& name) : Images(value, name, 1) {}

  /// @param value  one image, uint8 [H x W] or [H x W x 3]
  static Images single(const py::handle& value, const std::string& name) {
    return Images(value, name, 0);
  }

  Eigen::Index count() const { return first_ > 0 ? array_.shape(0) : 1; }
  /// "51 x 51" or "480 x 640 x 3"
  std::string size() const {
    return std::to_string(height_) + " x " + std::to_string(width_) +
           (channels_ == 3 ? " x 3" : "");
  }

  /// Grey values of an image as all nodes and programs compute them, see decodeImage().
  /// @return [image_size^2]
  std::vector<std::uint8_t> greyValues(Eigen::Index number, int image_size) const {
    const Eigen::Index bytes = height_ * width_ * channels_;
    const std::uint8_t* const begin = array_.data() + number * bytes;
    if (channels_ == 1 && height_ == image_size && width_ == image_size) {
      return std::vector<std::uint8_t>(begin, begin + bytes);
    }
    sensor_msgs::Image image;
    image.height = static_cast<std::uint32_t>(height_);
    image.width = static_cast<std::uint32_t>(width_);
    image.encoding = channels_ == 3 ? "rgb8" : "mono8";
    image.step = static_cast<std::uint32_t>(width_ * channels_);
    image.data.assign(begin, begin + bytes);
    return decodeImage(image, image_size);
  }

 private:
  Images(const py::handle& value, const std::string& name, int first) : first_(first) {
    const std::string begin = first > 0 ? "[T x " : "[";
    const std::string shape = begin + "H x W] or " + begin + "H x W x 3]";
    array_ = arrayOf<std::uint8_t>(value, name, shape, "uint8", "u");
    const bool colour = array_.ndim() == first + 3 && array_.shape(first + 2) == 3;
    if (!(colour || array_.ndim() == first + 2) || array_.size() == 0) {
      throw py::value_error(ruleOf(name, shape, "uint8") + ", not empty, got " + describe(array_));
    }
    height_ = array_.shape(first);
    width_ = array_.shape(first + 1);
    channels_ = colour ? 3 : 1;
  }

  py::array_t<std::uint8_t, py::array::c_style> array_;
  int first_;  // 1 if the first dimension counts images
  Eigen::Index height_ = 0, width_ = 0, channels_ = 1;
};

/// Converts a value of Python to YAML by way of JSON, which is valid YAML. Arrays of NumPy become
/// lists.
/// @throws py::type_error naming the option if a YAML file cannot have such a value
inline YAML::Node yamlOf(const py::handle& value, const std::string& name) {
  try {
    const py::object to_list = py::module::import("operator").attr("methodcaller")("tolist");
    const py::object text = py::module::import("json").attr("dumps")(
        value, py::arg("default") = to_list, py::arg("ensure_ascii") = false);
    return parseYaml(utf8Of(text, "option " + name), "option " + name);
  } catch (const py::error_already_set&) {
    throw py::type_error("option " + name +
                         " must be a number, true or false, a text or a list, got " +
                         describe(value));
  }
}

/// Converts YAML blocks to a dictionary.
inline py::object dictOf(const YAML::Node& blocks) {
  return py::module::import("yaml").attr("safe_load")(YAML::Dump(blocks));
}

/// Merges layers of blocks and the options of a Python function; later ones override earlier ones.
/// @param layers   paths of YAML files, or dictionaries of blocks
/// @param options  whole blocks, such as mpc={"horizon": 4}, or keys of `own`, such as horizon=4
/// @param own      blocks of the function with all of their keys
/// @throws py::type_error naming the option if neither `own` nor `options` has a block for it
inline YAML::Node mergedBlocks(const py::iterable& layers, const py::dict& options,
                               const YAML::Node& own) {
  YAML::Node merged(YAML::NodeType::Map);
  for (const py::handle& layer : layers) {
    overlay(py::isinstance<py::str>(layer) ? readBlocks(layer.cast<std::string>())
                                           : yamlOf(layer, "plant"),
            &merged);
  }
  for (const auto& option : options) {
    const std::string name = utf8Of(option.first, "the name of an option");
    YAML::Node given(YAML::NodeType::Map);
    std::vector<std::string> known;
    if (py::isinstance<py::dict>(option.second)) given[name] = yamlOf(option.second, name);
    for (const auto& block : own) {
      for (const auto& key : block.second) known.push_back(key.first.Scalar());
      if (given.size() > 0 || !hasKey(own, block.first.Scalar(), name)) continue;
      given[block.first.Scalar()][name] = yamlOf(option.second, name);
    }
    if (given.size() == 0) {
      std::string message = "unknown option " + name + ": there are";
      for (const std::string& key : known) message += " " + key;
      const std::string nearest = nearestName(name, known, 3);
      throw py::type_error(message + (nearest.empty() ? "" : "; did you mean " + nearest + "?"));
    }
    overlay(given, &merged);
  }
  return merged;
}

}  // namespace ddm
