-- The tables of a library. A step brings a database from the version before to its own; released steps never change.

-- version 1
CREATE TABLE designs (
    id TEXT PRIMARY KEY,
    name TEXT NOT NULL,
    head INTEGER NOT NULL,
    archived INTEGER NOT NULL DEFAULT 0);
CREATE TABLE revisions (
    design TEXT NOT NULL REFERENCES designs(id),
    number INTEGER NOT NULL,
    name TEXT NOT NULL,
    author TEXT NOT NULL,
    note TEXT NOT NULL,
    saved TEXT NOT NULL,
    text TEXT NOT NULL,
    content_hash TEXT NOT NULL,
    closes INTEGER,
    verdict TEXT NOT NULL,
    product TEXT NOT NULL,
    PRIMARY KEY (design, number));
CREATE TABLE tags (
    design TEXT NOT NULL REFERENCES designs(id),
    tag TEXT NOT NULL,
    PRIMARY KEY (design, tag));

-- version 2
ALTER TABLE revisions ADD COLUMN origin TEXT NOT NULL DEFAULT '';

-- version 3
CREATE TABLE reviews (
    id TEXT PRIMARY KEY,
    title TEXT NOT NULL,
    author TEXT NOT NULL,
    opened TEXT NOT NULL,
    product TEXT NOT NULL,
    version INTEGER NOT NULL DEFAULT 1,
    signed_by TEXT,
    signed TEXT,
    seal TEXT);
CREATE TABLE review_items (
    review TEXT NOT NULL REFERENCES reviews(id),
    place INTEGER NOT NULL,
    design TEXT NOT NULL,
    number INTEGER NOT NULL,
    content_hash TEXT NOT NULL,
    text_hash TEXT NOT NULL,
    PRIMARY KEY (review, place),
    FOREIGN KEY (design, number) REFERENCES revisions(design, number));
CREATE TABLE review_comments (
    review TEXT NOT NULL,
    number INTEGER NOT NULL,
    place INTEGER NOT NULL,
    subject TEXT NOT NULL,
    author TEXT NOT NULL,
    written TEXT NOT NULL,
    comment TEXT NOT NULL,
    PRIMARY KEY (review, number),
    FOREIGN KEY (review, place) REFERENCES review_items(review, place));
CREATE TABLE review_decisions (
    review TEXT NOT NULL,
    number INTEGER NOT NULL,
    place INTEGER NOT NULL,
    requirement TEXT NOT NULL,
    accepted INTEGER NOT NULL,
    figure TEXT NOT NULL,
    author TEXT NOT NULL,
    decided TEXT NOT NULL,
    reason TEXT NOT NULL,
    PRIMARY KEY (review, number),
    FOREIGN KEY (review, place) REFERENCES review_items(review, place));

-- version 4
ALTER TABLE reviews ADD COLUMN signature TEXT;

-- version 5
CREATE TABLE offers (name TEXT PRIMARY KEY, kept TEXT NOT NULL, text TEXT NOT NULL);

-- version 6
CREATE TABLE flights (
    design TEXT NOT NULL,
    number INTEGER NOT NULL,
    place INTEGER NOT NULL,
    author TEXT NOT NULL,
    saved TEXT NOT NULL,
    verdict TEXT NOT NULL,
    sentence TEXT NOT NULL,
    files TEXT NOT NULL,
    PRIMARY KEY (design, number, place),
    FOREIGN KEY (design, number) REFERENCES revisions(design, number));
