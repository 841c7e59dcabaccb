// Save the Kinect's pictures, the newest one in place of the others.
//
//     lcmtools msg generate --lang cpp types sensor_msgs
//     g++ kinect_viewer.cpp -Itypes $(lcmtools pkg cpp-path --flags) -o kinect_viewer
//     ./kinect_viewer --save kinect.pgm
//
// It needs the simulator: lcmtools run sim --world pioneer
// Compare with   lcmtools run image_view image:=/camera/depth/image_raw
#include <fstream>

#include <lcmtools/node.hpp>

#include <sensor_msgs/Image.hpp>

const char* const topic = "/camera/depth/image_raw";
const int farthest = 5000;  // [mm], is black

// Saves the pictures of the Kinect.
class KinectViewer : public lcmtools::Node {
 public:
  explicit KinectViewer(const std::string& file) : Node("kinect_viewer"), file_(file) {
#ifdef SKELETON
    // TODO: subscribe to sensor_msgs::Image on the topic `topic`, so that kinect_callback is called
    // with each picture: create_subscription<TYPE>(TOPIC, 1, FUNCTION);
    // with [this](const sensor_msgs::Image& image) { kinect_callback(image); } as the function.
    // The 1 keeps only the newest picture, should they come faster than they are saved.
#else
    create_subscription<sensor_msgs::Image>(
        topic, 1, [this](const sensor_msgs::Image& image) { kinect_callback(image); });
#endif
  }

 private:
  // Save one picture as a file of grey levels (PGM): near is light. This is complete; look at
  // image.encoding, width, height and data.
  void kinect_callback(const sensor_msgs::Image& image) {
    const std::string part = file_ + ".part";  // so that nobody reads half a picture
    std::ofstream stream(part, std::ios::binary);
    stream << "P5\n" << image.width << " " << image.height << "\n255\n";
    for (std::size_t i = 0; i + 1 < image.data.size(); i += 2) {
      const int depth = image.data[i] + 256 * image.data[i + 1];  // [mm], the low byte comes first
      const int grey = depth == 0 ? 0 : 255 - 255 * std::min(depth, farthest) / farthest;  // 0: no reading
      stream.put(static_cast<char>(grey));
    }
    stream.close();
    if (!stream || std::rename(part.c_str(), file_.c_str()) != 0) throw std::runtime_error("cannot write " + file_);
    get_logger().info(lcmtools::format("saved %s, %d x %d", file_.c_str(), image.width, image.height));
  }

  std::string file_;
};

int main(int argc, char** argv) {
  const auto words = lcmtools::init(argc, argv);
  const bool has_file = words.size() == 2 && words[0] == "--save";
  lcmtools::spin(std::make_shared<KinectViewer>(has_file ? words[1] : "kinect.pgm"));
}
