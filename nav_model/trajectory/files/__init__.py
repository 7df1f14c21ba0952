"""Flights from files: plans that are flown, recordings that are as they were flown.

    reader.py          parse_flight, read_flight: any file, told by its content -> PlannedFlight with a note
    kml.py, gpx.py     KML, KMZ, WPML; GPX
    ground_station.py  .plan of QGroundControl, .waypoints
    sbet.py, table.py  SBET; columns of a text, as other programs name them
    recorded.py        the flight through recorded places
    heights.py         what heights are above; names; what was read by convention
    markup.py          bounded XML and archives

Import from the modules; this one imports nothing.
"""
