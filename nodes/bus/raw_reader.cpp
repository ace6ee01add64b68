#include "nodes/bus/raw_reader.hpp"

namespace voxtouch::bus {

RawReader::RawReader(dds_entity_t participant, const std::string& topic,
                     const dds_topic_descriptor_t& type, const dds_qos_t* qos)
    : topic_(dds_create_topic(participant, &type, topic.c_str(), nullptr, nullptr),
             "topic " + topic + " cannot be created"),
      reader_(dds_create_reader(participant, topic_.get(), qos, nullptr),
              "a reader on " + topic + " cannot be created"),
      unread_(dds_create_readcondition(reader_.get(), DDS_ANY_STATE),
              "cannot create a read condition") {}

}  // namespace voxtouch::bus
