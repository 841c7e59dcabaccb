// The parameters of a node. Include node.hpp instead.
#pragma once

#include "lcmtools/publisher.hpp"
#include "lcmtools/value.hpp"

namespace lcmtools {

// A node's parameter with its current value.
class Parameter {
 public:
  template <class T>
  Parameter(std::string name, const T& value) : name_(std::move(name)), value_(detail::as_value(value)) {}
  Parameter(std::string name, Value value, std::string node = "")
      : name_(std::move(name)), node_(std::move(node)), value_(std::move(value)) {}

  const std::string& get_name() const { return name_; }
  const Value& get_value() const { return value_; }
  bool as_bool() const { return as<bool>(); }
  std::int64_t as_int() const { return as<std::int64_t>(); }
  double as_double() const { return as<double>(); }
  const std::string& as_string() const { return as<std::string>(); }

  template <class T>
  const T& as() const {
    if (const T* value = std::get_if<T>(&value_)) return *value;
    const char* asked = detail::kinds[Value(T()).index()];
    throw Error((node_.empty() ? "" : node_ + ": ") + "the parameter '" + name_ + "' is " + detail::kinds[value_.index()] + ", not " + asked,
                std::string("write ") + detail::readers[value_.index()]);
  }

 private:
  std::string name_, node_;
  Value value_;
};

struct ParameterDescriptor {
  std::string description = "";
  std::optional<double> minimum = {}, maximum = {};
  bool read_only = false;
};

// The parameters of a node: its own functions, of which it makes a service.
class Parameters {
 public:
  using OnSetParameters = std::function<std::string(const std::vector<Parameter>&)>;

  // Declare a setting with its default, and return its value: `_name:=value` on the command line
  // overrides the default. All its values have the default's type.
  template <class T>
  auto declare_parameter(const std::string& name, const T& standard, ParameterDescriptor about = {}) {
    using Kind = decltype(detail::as_value(standard));
    Value value = detail::as_value(standard);
    const auto given = context_->arguments.parameters.find(name);
    if (given != context_->arguments.parameters.end()) value = detail::read_value(given->second, value, "parameter " + name);
    check_range(name, value, about);
    if (!add(name, {value, std::move(about)})) throw Error(node_->name + " declares its parameter '" + name + "' twice");
    return std::get<Kind>(value);
  }
  bool has_parameter(const std::string& name) const {
    const std::lock_guard lock(context_->mutex);
    return parameters_.count(name) > 0;
  }
  Parameter get_parameter(const std::string& name) const { return {name, declared(name).value, node_->name}; }
  // Change all of these parameters, or none: return the reason why not, or "".
  std::string set_parameters_atomically(const std::vector<Parameter>& parameters) {
    try {
      std::vector<Parameter> checked;
      for (const auto& one : parameters) checked.push_back(this->checked(one));
      for (auto callback = on_set_.rbegin(); callback != on_set_.rend(); ++callback)
        if (const auto reason = (*callback)(checked); !reason.empty()) return reason;
      const std::lock_guard lock(context_->mutex);
      for (const auto& one : checked) parameters_.at(one.get_name()).value = one.get_value();
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  }
  std::string set_parameter(const Parameter& parameter) { return set_parameters_atomically({parameter}); }

  // Call a function before parameters change; it returns the reason for which it refuses, or "".
  void add_on_set_parameters_callback(OnSetParameters callback) { on_set_.push_back(std::move(callback)); }

 private:
  friend class Node;
  struct Declared {
    Value value;
    ParameterDescriptor about;
  };

  // Answer a request of the service: change parameters, and report all of them.
  void answer_parameters(const wire::Parameters_Request& request, wire::Parameters_Response& response) {
    std::vector<Parameter> requested;
    for (const auto& change : request.changes) {
      try {
        const auto like = get_parameter(change.name).get_value();
        requested.emplace_back(change.name, detail::read_value(change.value, like, "parameter " + change.name));
      } catch (const Error& error) {
        response.errors.emplace_back(error.what());
      }
    }
    if (!requested.empty() && response.errors.empty())
      if (const auto reason = set_parameters_atomically(requested); !reason.empty()) response.errors.push_back(reason);
    const std::lock_guard lock(context_->mutex);
    for (const auto& [name, one] : parameters_) {
      const auto bound = [](const std::optional<double>& limit) { return limit ? detail::write(*limit) : ""; };
      response.parameters.push_back({name, detail::kinds[one.value.index()], detail::write_value(one.value),
                                     one.about.description, bound(one.about.minimum), bound(one.about.maximum),
                                     one.about.read_only});
    }
  }

  std::shared_ptr<detail::Context> context_ = detail::current_context();
  std::shared_ptr<detail::Participant> node_ = std::make_shared<detail::Participant>();

  // An Error that nobody catches ends the program, which takes the mutex to say goodbye: none is thrown
  // while it is held.
  bool add(const std::string& name, const Declared& parameter) {
    const std::lock_guard lock(context_->mutex);
    context_->declared.insert(name);
    return parameters_.emplace(name, parameter).second;
  }
  Declared declared(const std::string& name) const {
    std::unique_lock lock(context_->mutex);
    const auto found = parameters_.find(name);
    if (found != parameters_.end()) return found->second;
    std::string known;
    for (const auto& [other, value] : parameters_) known += (known.empty() ? "" : ", ") + other;
    lock.unlock();
    throw Error(node_->name + " has no parameter '" + name + "'", "it has " + known);
  }

  // Return a parameter with the declared type; throw Error if it may not have the value.
  Parameter checked(const Parameter& parameter) const {
    const auto [old, about] = declared(parameter.get_name());
    const std::string name = "parameter " + parameter.get_name();
    Value value = parameter.get_value();
    if (std::holds_alternative<double>(old) && std::holds_alternative<std::int64_t>(value))
      value = static_cast<double>(std::get<std::int64_t>(value));
    if (value.index() != old.index()) throw Error(name + " is " + detail::kinds[old.index()] + ", not " + detail::kinds[value.index()]);
    if (about.read_only && value != old)
      throw Error(name + " cannot change while the node runs", "start it again with _" + parameter.get_name() + ":=" + detail::write_value(value));
    check_range(parameter.get_name(), value, about);
    return {parameter.get_name(), value};
  }

  static void check_range(const std::string& name, const Value& value, const ParameterDescriptor& about) {
    const auto check = [&](double number) {
      const std::string text = "parameter " + name + ": " + format("%g", number);
      if (about.minimum && !(number >= *about.minimum)) throw Error(text + format(" is less than %g", *about.minimum));
      if (about.maximum && !(number <= *about.maximum)) throw Error(text + format(" is more than %g", *about.maximum));
    };
    std::visit([&](const auto& inside) {
      using T = std::decay_t<decltype(inside)>;
      if constexpr (std::is_same_v<T, double> || std::is_same_v<T, std::int64_t>) check(static_cast<double>(inside));
      if constexpr (std::is_same_v<T, std::vector<double>> || std::is_same_v<T, std::vector<std::int64_t>>)
        for (auto number : inside) check(static_cast<double>(number));
    }, value);
  }

  std::map<std::string, Declared> parameters_;
  std::vector<OnSetParameters> on_set_;
};

}  // namespace lcmtools
