"""Solutions of navigation from the files of receivers, autopilots and post-processors."""
