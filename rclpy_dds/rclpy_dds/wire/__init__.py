"""ROS 2 on the wire: names, types, quality of service, entities and the graph, as rmw_cyclonedds_cpp has them."""
