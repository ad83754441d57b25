//! Random programs.

use super::super::common::Random;

/// A vector to read.
#[derive(Clone, Debug)]
pub enum Source {
    V,
    W,
    G,
    Let(usize),
    CopyV(usize),
    Swizzle([usize; 4], Box<Source>),
    Sum(Box<Source>, Box<Source>),
    Splat(usize, Box<Source>),
}

/// A scalar to read.
#[derive(Clone, Debug)]
pub enum Number {
    Constant(i32),
    Component(Source, usize),
    Dynamic(Box<Number>),
    N(Box<Number>),
    M(Box<Number>, usize),
}

#[derive(Clone, Debug)]
pub enum Statement {
    Let(usize, Source),
    Copy(usize),
    SetV(Source),
    SetW(Source),
    SetG(Source),
    SetComponent(usize, Number),
    AddW(usize, Number),
    SetDynamic(Number, Number),
    SetN(Number, Number),
    SetM(Number, usize, Number),
    SwapM,
    Touch(Source, Number),
    Blend(Source),
    Late(Number, Source),
    LoopOver(Source, usize),
    Read,
    Globals(Number),
    Restore(usize),
    If(Number, Vec<Statement>, Vec<Statement>),
    For(usize, u32, Vec<Statement>),
    Switch(Number, Vec<Statement>, Vec<Statement>, Vec<Statement>),
    BreakIf(Number),
    ContinueIf(Number),
    ReturnIf(Number),
}

pub struct Generator<'a> {
    pub random: &'a mut Random,
    pub names: usize,
    pub budget: usize,
}

/// Names in scope: vectors, and copies of the struct.
pub type Names = Vec<(usize, bool)>;

impl Generator<'_> {
    fn name(&mut self) -> usize {
        self.names += 1;
        self.names
    }

    fn known(&mut self, names: &Names, is_copy: bool) -> Option<usize> {
        let known: Vec<usize> = names
            .iter()
            .filter(|(_, copy)| *copy == is_copy)
            .map(|(name, _)| *name)
            .collect();
        if known.is_empty() {
            None
        } else {
            Some(known[self.random.u32(known.len() as u32) as usize])
        }
    }

    fn source(&mut self, names: &Names, depth: u32) -> Source {
        let boxed = |generator: &mut Self| Box::new(generator.source(names, depth + 1));
        match self.random.u32(if depth > 2 { 6 } else { 9 }) {
            0 | 1 => Source::V,
            2 => Source::W,
            3 => Source::G,
            4 => self.known(names, false).map_or(Source::V, Source::Let),
            5 => self.known(names, true).map_or(Source::W, Source::CopyV),
            6 => Source::Swizzle(
                std::array::from_fn(|_| self.random.u32(4) as usize),
                boxed(self),
            ),
            7 => Source::Sum(boxed(self), boxed(self)),
            _ => Source::Splat(self.random.u32(4) as usize, boxed(self)),
        }
    }

    fn number(&mut self, names: &Names, depth: u32) -> Number {
        let boxed = |generator: &mut Self| Box::new(generator.number(names, depth + 1));
        match self.random.u32(if depth > 2 { 3 } else { 6 }) {
            0 => Number::Constant(self.random.bits() as i32 >> self.random.u32(31)),
            1 | 2 => Number::Component(self.source(names, depth + 1), self.random.u32(4) as usize),
            3 => Number::Dynamic(boxed(self)),
            4 => Number::N(boxed(self)),
            _ => Number::M(boxed(self), self.random.u32(2) as usize),
        }
    }

    pub fn block(&mut self, depth: u32, names: &mut Names) -> Vec<Statement> {
        let mut statements = Vec::new();
        let outside = names.len();
        for _ in 0..1 + self.random.u32(if depth == 0 { 14 } else { 6 }) {
            if self.budget == 0 {
                break;
            }
            self.budget -= 1;
            statements.push(self.statement(depth, names));
        }
        names.truncate(outside);
        statements
    }

    fn statement(&mut self, depth: u32, names: &mut Names) -> Statement {
        match self.random.u32(if depth > 3 { 20 } else { 27 }) {
            0 | 1 => {
                let source = self.source(names, 0);
                let name = self.name();
                names.push((name, false));
                Statement::Let(name, source)
            }
            2 => {
                let name = self.name();
                names.push((name, true));
                Statement::Copy(name)
            }
            3 => Statement::SetV(self.source(names, 0)),
            4 => Statement::SetW(self.source(names, 0)),
            5 => Statement::SetG(self.source(names, 0)),
            6 | 7 => Statement::SetComponent(self.random.u32(4) as usize, self.number(names, 0)),
            8 => Statement::AddW(self.random.u32(4) as usize, self.number(names, 0)),
            9 => Statement::SetDynamic(self.number(names, 0), self.number(names, 0)),
            10 => Statement::SetN(self.number(names, 0), self.number(names, 0)),
            11 => Statement::SetM(
                self.number(names, 0),
                self.random.u32(2) as usize,
                self.number(names, 0),
            ),
            12 => Statement::SwapM,
            13 => Statement::Touch(self.source(names, 0), self.number(names, 0)),
            14 => Statement::Read,
            15 => Statement::Globals(self.number(names, 0)),
            16 => self
                .known(names, true)
                .map_or(Statement::SwapM, Statement::Restore),
            17 => Statement::Blend(self.source(names, 0)),
            18 => Statement::Late(self.number(names, 0), self.source(names, 0)),
            19 => Statement::LoopOver(self.source(names, 0), self.random.u32(4) as usize),
            20 | 21 => Statement::If(
                self.number(names, 0),
                self.block(depth + 1, names),
                self.block(depth + 1, names),
            ),
            22 | 23 => {
                let name = self.name();
                Statement::For(name, self.random.u32(5), self.block(depth + 1, names))
            }
            24 => {
                let selector = self.number(names, 0);
                Statement::Switch(
                    selector,
                    self.block(depth + 1, names),
                    self.block(depth + 1, names),
                    self.block(depth + 1, names),
                )
            }
            25 if self.random.u32(2) == 0 => Statement::ReturnIf(self.number(names, 0)),
            25 => Statement::BreakIf(self.number(names, 0)),
            _ => Statement::ContinueIf(self.number(names, 0)),
        }
    }
}
